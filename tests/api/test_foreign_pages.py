"""Web pages elsewhere that the configuration allows to use the API."""

import httpx
import pytest

from station.api.app import create_app
from station.api.server import ApiServer
from station.web.host_policy import HostPolicy
from tests.api.conftest import OPERATOR, URL, AppTransport
from tests.api.test_server import open_stream
from tests.waiting import PATIENCE

PAGE = "http://lab.example:5173"
BEARER = {"Authorization": f"Bearer {OPERATOR}"}


@pytest.fixture
def open_app(station, authenticator):
    """Return the app of a station that a page elsewhere may use."""
    return create_app(station, authenticator, HostPolicy(origins=[PAGE]))


@pytest.fixture
def page(open_app):
    """Return what asks as that page does."""
    headers = {"Origin": PAGE}
    transport = AppTransport(open_app)
    with httpx.Client(transport=transport, base_url=URL, headers=headers) as page:
        yield page


def preflight(page, origin=PAGE, header="authorization,if-match"):
    return page.options(
        "/api/v1/controllers/spring/gains",
        headers={
            "Origin": origin,
            "Access-Control-Request-Method": "PATCH",
            "Access-Control-Request-Headers": header,
            "Access-Control-Request-Private-Network": "true",
        },
    )


def test_a_browser_is_told_what_an_allowed_page_may_do(page):
    answer = preflight(page)

    assert answer.status_code == 200
    assert answer.headers["access-control-allow-origin"] == PAGE
    assert "PATCH" in answer.headers["access-control-allow-methods"]
    assert answer.headers["access-control-allow-private-network"] == "true"
    assert "access-control-allow-credentials" not in answer.headers
    assert preflight(page, header="x-else").status_code == 400
    refused = preflight(page, origin="http://evil.example")
    assert refused.status_code == 403
    assert "access-control-allow-origin" not in refused.headers


def test_an_allowed_page_reads_and_changes_with_a_token(page):
    assert page.get("/api/v1/status").status_code == 401
    read = page.get("/api/v1/status", headers=BEARER)
    stopped = page.post("/api/v1/stop", headers=BEARER)

    assert (read.status_code, stopped.status_code) == (200, 200)
    assert read.headers["access-control-allow-origin"] == PAGE
    assert "ETag" in read.headers["access-control-expose-headers"]


def test_an_allowed_page_opens_streams(open_app):
    with ApiServer(open_app, port=0) as server:
        headers = {**BEARER, "Origin": PAGE}
        with open_stream(server, headers=headers) as stream:
            assert '"hello"' in stream.recv(timeout=PATIENCE)


def test_no_page_elsewhere_is_allowed_by_default(operator):
    answer = operator.get("/api/v1/status", headers={"Origin": PAGE})

    assert answer.status_code == 403
    assert "api.allowed_origins" in answer.json()["remedy"]
    assert "access-control-allow-origin" not in answer.headers
