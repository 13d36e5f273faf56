"""Every route asks for the role it should: taken from the OpenAPI document."""

from itertools import product

import httpx
import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.web.failed_logins import FailedLogins
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.api.openapi_document import operations
from tests.api.spring import make_station
from tests.api.test_errors import problem_of
from tests.api.test_who_gets_in import no_sleep
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
    """Ask a station of its own, which nobody else has changed."""
    return ask_app(*make_app(), route, **kwargs)


def make_app():
    """Return an app, which answers wrong tokens at once, and its station."""
    station = make_station()
    station.loop.step()
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    app.state.services.failed_logins = FailedLogins(sleep=no_sleep)
    return app, station


def ask_app(app, station, route, **kwargs):
    """Ask an app; return its answer and the station."""
    method, path = route
    path = path.replace("{name}", "spring").replace("{topic}", "loop")
    with httpx.Client(transport=AppTransport(app), base_url=URL) as http:
        return http.request(method, path, **kwargs), station


@pytest.fixture
def refusing():
    """Return an app and its station, for requests that change nothing."""
    return make_app()


def test_there_are_routes_of_every_kind():
    assert len(PROTECTED) > 15
    assert len(CHANGING) > 6
    assert set(ROUTES) >= OPEN | ANY_ROLE


@for_each(
    "route, header",
    product(PROTECTED, [None, "Bearer wrong", "Basic b3A6"]),
)
def test_requests_without_a_token_are_refused(refusing, route, header):
    headers = {} if header is None else {"Authorization": header}

    answer, station = ask_app(*refusing, route, headers=headers)

    problem_of(answer, 401, "unauthorized")
    assert answer.headers["www-authenticate"] == "Bearer"
    assert station.epoch == 1


@for_each("route", CHANGING)
def test_a_viewer_changes_nothing(refusing, route):
    answer, station = ask_app(*refusing, route, headers=AS_VIEWER)

    problem_of(answer, 403, "operator_needed")
    assert station.epoch == 1


@for_each("route", sorted(ANY_ROLE))
def test_a_viewer_may_stop_and_watch(route):
    answer, _ = ask(route, headers=AS_VIEWER)

    assert answer.status_code == 200


@for_each("route", CHANGING)
def test_the_role_is_checked_before_the_body(refusing, route):
    answer, _ = ask_app(*refusing, route, json={"x": 1}, headers=AS_VIEWER)

    problem_of(answer, 403, "operator_needed")
