"""Every route that changes something, and everybody who must not use it.

The routes are those of the app itself, so that a new one is tried, too.
"""

import asyncio
import re

import httpx
import pytest
from websockets.exceptions import ConnectionClosed

from station.api.app import create_app
from station.api.auth import Access, Authenticator, Role
from station.api.routes import PREFIX
from station.api.server import ApiServer
from station.events import Origin
from station.web.failed_logins import FailedLogins
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.api.spring import make_station
from tests.api.test_server import open_stream
from tests.franka_station import make_franka_station

READS = {"get", "head", "options"}
CHANGES = sorted(
    (method.upper(), PREFIX + re.sub(r"\{\w+\}", "x", path.removeprefix(PREFIX)))
    for path, methods in create_app(make_franka_station(), Authenticator())
    .openapi()["paths"]
    .items()
    for method in methods
    if method not in READS
)
# A token is what a login asks for, and a logout ends only the session that it shows.
WITHOUT_TOKEN = {"/login", "/logout"}
# A viewer may stop the robot and look at it.
VIEWERS = {*WITHOUT_TOKEN, "/stop", "/stream-tickets"}
# Nobody's control keeps others from stopping, looking, asking for control, or ending
# the token of whoever holds it.
WHOEVER_HOLDS_CONTROL = {*VIEWERS, "/tokens", "/tokens/x"}


def but(exceptions):
    """Return the changes without those of some paths."""
    return [one for one in CHANGES if one[1].removeprefix(PREFIX) not in exceptions]


@pytest.fixture(scope="module")
def app():
    """Return an app of an arm that nobody moves; every request to it is refused."""
    app = create_app(make_franka_station(), Authenticator(OPERATOR, VIEWER))
    app.state.failed_logins = FailedLogins(sleep=no_sleep)
    return app


async def no_sleep(_):
    """Answer wrong tokens at once."""


@pytest.fixture(scope="module")
def bare(app):
    """Return a client without a token."""
    with httpx.Client(transport=AppTransport(app), base_url=URL) as client:
        yield client


def bearer(token):
    return {"Authorization": f"Bearer {token}"}


def test_the_routes_are_many_and_of_all_kinds():
    assert len(CHANGES) > 40
    assert {method for method, _ in CHANGES} == {"POST", "PUT", "PATCH", "DELETE"}


@pytest.mark.parametrize(("method", "path"), but(WITHOUT_TOKEN))
def test_without_a_token(bare, method, path):
    assert bare.request(method, path).status_code == 401


@pytest.mark.parametrize(("method", "path"), but(VIEWERS))
def test_a_viewer(bare, method, path):
    answer = bare.request(method, path, headers=bearer(VIEWER))

    assert (answer.status_code, answer.json()["code"]) == (403, "operator_needed")


@pytest.mark.parametrize(("method", "path"), CHANGES)
def test_a_page_of_another_origin(bare, method, path):
    headers = {**bearer(OPERATOR), "Origin": "http://evil.example"}
    answer = bare.request(method, path, headers=headers)

    assert (answer.status_code, answer.json()["code"]) == (403, "origin_not_allowed")


@pytest.mark.parametrize(("method", "path"), CHANGES)
def test_a_host_that_was_rebound(bare, method, path):
    headers = {**bearer(OPERATOR), "Host": "evil.example:8000"}
    answer = bare.request(method, path, headers=headers)

    assert (answer.status_code, answer.json()["code"]) == (403, "host_not_allowed")


@pytest.mark.parametrize(("method", "path"), but(WHOEVER_HOLDS_CONTROL))
def test_while_another_operator_holds_control(bare, app, method, path):
    control = app.state.control
    access = Access(Role.OPERATOR)
    control.take(access, None, "Ada", 1000.0, force=True, origin=Origin())
    body = {"json": {}} if method in {"POST", "PATCH"} and "control" in path else {}

    answer = bare.request(method, path, headers=bearer(OPERATOR), **body)

    assert answer.status_code == 423
    assert "Ada holds control" in answer.json()["detail"]


@pytest.mark.parametrize(("method", "path"), but(WITHOUT_TOKEN))
def test_a_revoked_token(bare, app, method, path):
    named = app.state.authenticator.named
    secret = asyncio.run(named.create("eve", "operator", None))
    asyncio.run(named.revoke("eve"))

    assert bare.request(method, path, headers=bearer(secret)).status_code == 401


def test_a_revoked_token_with_an_open_socket():
    app = create_app(make_station(), Authenticator(OPERATOR, VIEWER))
    named = app.state.authenticator.named
    secret = asyncio.run(named.create("eve", "operator", None))
    with (
        ApiServer(app, port=0) as server,
        httpx.Client(base_url=server.url, trust_env=False) as client,
        open_stream(server, "loop", bearer(secret)) as stream,
    ):
        stream.recv(timeout=5.0)
        headers = bearer(OPERATOR)
        client.delete("/api/v1/tokens/eve", headers=headers).raise_for_status()
        with pytest.raises(ConnectionClosed) as closed:
            list(stream)
        answer = client.post("/api/v1/stop", headers=bearer(secret))

    assert closed.value.rcvd.code == 4401
    assert answer.status_code == 401
