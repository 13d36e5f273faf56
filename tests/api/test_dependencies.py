"""Every route asks for the role it should: taken from the OpenAPI document."""

from itertools import product

import httpx

from station.api.app import create_app
from station.api.auth import Authenticator
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.api.openapi_document import operations
from tests.api.spring import make_station
from tests.api.test_errors import problem_of
from tests.for_each import for_each

OPEN = {
    ("GET", "/api/v1/health"),
    ("GET", "/api/v1/ready"),
    ("POST", "/api/v1/login"),
    ("POST", "/api/v1/logout"),
}
"""Needs no token: probes, and getting in and out."""

ANY_ROLE = {("POST", "/api/v1/stop"), ("POST", "/api/v1/stream-tickets")}
"""Changes something (or seems to), and yet a viewer may."""


ROUTES = sorted(operations())
PROTECTED = [route for route in ROUTES if route not in OPEN]
CHANGING = [r for r in PROTECTED if r[0] != "GET" and r not in ANY_ROLE]
AS_VIEWER = {"Authorization": f"Bearer {VIEWER}"}


def ask(route, **kwargs):
    """Ask a station of its own, so that no refusal slows or changes the next."""
    method, path = route
    path = path.replace("{name}", "spring").replace("{topic}", "loop")
    station = make_station()
    station.loop.step()
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with httpx.Client(transport=AppTransport(app), base_url=URL) as http:
        return http.request(method, path, **kwargs), station


def test_there_are_routes_of_every_kind():
    assert len(PROTECTED) > 15
    assert len(CHANGING) > 6
    assert set(ROUTES) >= OPEN | ANY_ROLE


@for_each(
    "route, header",
    product(PROTECTED, [None, "Bearer wrong", "Basic b3A6"]),
)
def test_requests_without_a_token_are_refused(route, header):
    headers = {} if header is None else {"Authorization": header}

    answer, station = ask(route, headers=headers)

    problem_of(answer, 401, "unauthorized")
    assert answer.headers["www-authenticate"] == "Bearer"
    assert station.epoch == 1


@for_each("route", CHANGING)
def test_a_viewer_changes_nothing(route):
    answer, station = ask(route, headers=AS_VIEWER)

    problem_of(answer, 403, "operator_needed")
    assert station.epoch == 1


@for_each("route", sorted(ANY_ROLE))
def test_a_viewer_may_stop_and_watch(route):
    answer, _ = ask(route, headers=AS_VIEWER)

    assert answer.status_code == 200


@for_each("route", CHANGING)
def test_the_role_is_checked_before_the_body(route):
    answer, _ = ask(route, json={"x": 1}, headers=AS_VIEWER)

    problem_of(answer, 403, "operator_needed")
