"""The application as a whole."""

import httpx

from station.api.app import create_app
from station.api.auth import Authenticator
from station.web.host_policy import HostPolicy
from tests.api.conftest import AppTransport
from tests.api.spring import make_station


def test_a_configured_host_is_answered():
    app = create_app(make_station(), Authenticator(), HostPolicy(hosts=["robot.lab"]))
    with httpx.Client(
        transport=AppTransport(app), base_url="http://robot.lab:8000"
    ) as http:
        assert http.get("/api/v1/session").status_code == 401


def test_no_router_stands_between_a_request_and_its_route(app):
    assert [route for route in app.routes if not hasattr(route, "path")] == []


def test_the_body_limit_can_be_set(station, authenticator):
    app = create_app(station, authenticator, max_body=10)
    with httpx.Client(transport=AppTransport(app), base_url="http://127.0.0.1") as http:
        answer = http.post("/api/v1/login", json={"token": "x"})
    assert answer.status_code == 413


def test_paths_are_known_without_the_document():
    app = create_app(make_station(), Authenticator())

    document = app.openapi()["paths"]

    assert app.methods_by_path() == {
        path: {method.upper() for method in operations}
        for path, operations in document.items()
    }
