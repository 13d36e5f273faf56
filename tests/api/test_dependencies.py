"""Every route asks for the role it should: taken from the OpenAPI document."""

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from tests.api.conftest import VIEWER
from tests.api.spring import make_station
from tests.api.test_errors import problem_of

OPEN = {
    ("GET", "/api/v1/health"),
    ("GET", "/api/v1/ready"),
    ("POST", "/api/v1/login"),
    ("POST", "/api/v1/logout"),
}
"""Needs no token: probes, and getting in and out."""

ANY_ROLE = {("POST", "/api/v1/stop"), ("POST", "/api/v1/stream-tickets")}
"""Changes something (or seems to), and yet a viewer may."""


def routes():
    paths = create_app(make_station(), Authenticator()).openapi()["paths"]
    return sorted(
        (method.upper(), path) for path, methods in paths.items() for method in methods
    )


PROTECTED = [route for route in routes() if route not in OPEN]
CHANGING = [r for r in PROTECTED if r[0] != "GET" and r not in ANY_ROLE]


def ask(http, route, **kwargs):
    method, path = route
    path = path.replace("{name}", "spring").replace("{topic}", "loop")
    return http.request(method, path, **kwargs)


def test_there_are_routes_of_every_kind():
    assert len(PROTECTED) > 15
    assert len(CHANGING) > 6
    assert set(routes()) >= OPEN | ANY_ROLE


@pytest.mark.parametrize("route", PROTECTED)
@pytest.mark.parametrize("header", [None, "Bearer wrong", "Basic b3A6"])
def test_requests_without_a_token_are_refused(http, station, route, header):
    headers = {} if header is None else {"Authorization": header}

    answer = ask(http, route, headers=headers)

    problem_of(answer, 401, "unauthorized")
    assert answer.headers["www-authenticate"] == "Bearer"
    assert station.epoch == 1


@pytest.mark.parametrize("route", CHANGING)
def test_a_viewer_changes_nothing(http, station, route):
    answer = ask(http, route, headers={"Authorization": f"Bearer {VIEWER}"})

    problem_of(answer, 403, "operator_needed")
    assert station.epoch == 1


@pytest.mark.parametrize("route", sorted(ANY_ROLE))
def test_a_viewer_may_stop_and_watch(http, route):
    answer = ask(http, route, headers={"Authorization": f"Bearer {VIEWER}"})

    assert answer.status_code == 200


@pytest.mark.parametrize("route", CHANGING)
def test_the_role_is_checked_before_the_body(http, route):
    answer = ask(
        http, route, json={"x": 1}, headers={"Authorization": f"Bearer {VIEWER}"}
    )

    problem_of(answer, 403, "operator_needed")
