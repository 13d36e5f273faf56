"""The page at the root says where things are."""

import httpx
import pytest

from station.api.app import create_app
from tests.api.conftest import URL, AppTransport


def test_the_root_needs_no_token_and_names_the_parts(http):
    found = http.get("/").json()

    assert found["api"] == "/api/v1"
    assert "dashboard" not in found


@pytest.mark.parametrize("part", ["docs", "openapi", "health"])
def test_every_address_answers(http, part):
    assert http.get(http.get("/").json()[part]).status_code == 200


def test_index_names_the_dashboard_once_its_address_is_known(station, authenticator):
    addresses = [None, "http://127.0.0.1:8080"]
    app = create_app(station, authenticator, dashboard_url=lambda: addresses.pop(0))

    with httpx.Client(transport=AppTransport(app), base_url=URL) as client:
        assert "dashboard" not in client.get("/").json()
        assert client.get("/").json()["dashboard"] == "http://127.0.0.1:8080"
