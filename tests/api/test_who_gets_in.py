"""Every route of the app, and everybody who must not get in.

The routes are those of the app's own table, WebSockets among them, so that a new one is
tried, too.
"""

import asyncio
import re
import socket
from dataclasses import dataclass

import httpx
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.api.app import create_app
from station.api.auth import Access, Authenticator, Role
from station.api.server import ApiServer
from station.events import Origin
from station.web.failed_logins import FailedLogins
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.spring import make_station
from tests.api.test_server import open_stream
from tests.franka_station import make_franka_station
from tests.waiting import PATIENCE

SOCKET = "WebSocket"
READS = {"GET", "HEAD"}
API = "/api/v1"
# What stands for the parameters of a path: what this station has, else `x`.
KNOWN = {"name": "arm", "controller": "arm", "arm_id": "panda", "topic": "loop"}

# They say whether the process lives, to supervisors that know neither name nor token.
PROBES = {f"{API}/health", f"{API}/ready"}
# They say where the parts of the station are, and nothing of the robot.
PUBLIC = {"/", "/docs", "/docs/start.js", "/docs/arm"}
PUBLIC |= {f"{API}/openapi.json", f"{API}/asyncapi.json"}
# A logout ends only the session that it shows.
LOGOUT = f"{API}/logout"
# A viewer may read, and stop the robot.
OF_VIEWERS = {LOGOUT, f"{API}/stop", f"{API}/stream-tickets"}
# The token in the body or the query decides, whoever sends it.
LOGINS = {f"{API}/login", "/login"}
TOKENS = {f"{API}/tokens", f"{API}/tokens/arm"}
ANSWER = f"{API}/agents/requests/x"
# These look at what a request says before they look at who holds control.
CONTROL = {"POST": {"owner": "Bob"}, "PATCH": {"ttl": 5.0}}


def bearer(token):
    return {"Authorization": f"Bearer {token}"}


@dataclass
class Caller:
    """Somebody who must not get in.

    Attributes:
        headers: What their requests show.
        refusals: Status and code of a refused request, and the close code of a stream.
        may: Returns whether they may use a route nevertheless.
    """

    headers: dict[str, str]
    refusals: tuple[int, str, int]
    may: callable


CALLERS = {
    "no token": Caller(
        {},
        (401, "unauthorized", 4401),
        lambda _, path: path in PROBES | PUBLIC | {LOGOUT},
    ),
    "revoked token": Caller(
        bearer("revoked"),
        (401, "unauthorized", 4401),
        lambda _, path: path in PROBES | PUBLIC | {LOGOUT},
    ),
    "viewer": Caller(
        bearer(VIEWER),
        (403, "operator_needed", 4403),
        lambda method, path: (
            (method in READS and path not in TOKENS)
            or path in OF_VIEWERS | {f"{API}/streams/loop"}
        ),
    ),
    "foreign Origin": Caller(
        {**bearer(OPERATOR), "Origin": "http://evil.example"},
        (403, "origin_not_allowed", 4403),
        lambda _, path: path in PROBES,
    ),
    "rebound Host": Caller(
        {**bearer(OPERATOR), "Host": "evil.example:8000"},
        (403, "host_not_allowed", 4403),
        lambda _, path: path in PROBES,
    ),
    # Nobody's control keeps others from stopping, looking, rehearsing (nothing moves),
    # answering an agent, or ending the token of whoever holds it.
    "another's lease": Caller(
        {**bearer(OPERATOR), "X-Control-Lease": "not-theirs"},
        (423, "control_held", 4423),
        lambda method, path: (
            method in READS
            or path
            in OF_VIEWERS | TOKENS | {f"{API}/streams/loop", f"{API}/rehearse", ANSWER}
        ),
    ),
}


async def no_sleep(_):
    """Answer wrong tokens at once."""


@pytest.fixture(scope="module")
def app():
    """Return the app of an arm that Ada controls."""
    app = create_app(make_franka_station(), Authenticator(OPERATOR, VIEWER))
    app.state.services.failed_logins = FailedLogins(sleep=no_sleep)
    take = app.state.services.control.take
    take(Access(Role.OPERATOR), None, "Ada", 1000.0, origin=Origin())
    named = app.state.services.authenticator.named
    secret = asyncio.run(named.create("eve", "operator", None))
    CALLERS["revoked token"].headers = bearer(secret)
    asyncio.run(named.revoke("eve"))
    return app


def routes_of(app):
    """Return method and path of each route; a WebSocket's method is `SOCKET`."""
    for route in app.routes:
        path = re.sub(
            r"\{(\w+)(:path)?\}", lambda m: KNOWN.get(m[1], "x"), route.path_format
        )
        methods = set(getattr(route, "methods", None) or {SOCKET})
        if "GET" in methods:
            methods.add("HEAD")  # the same answer without its body
        for method in sorted(methods):
            yield method, path


def refusal(http, method, path, headers):
    """Return status and code of the answer to a request."""
    sent = {}
    if path == f"{API}/control" and method in CONTROL:
        sent = {"json": CONTROL[method]}
    elif path in LOGINS:
        wrong = {"token": "wrong"}
        sent = {"params": wrong} if method in READS else {"json": wrong}
    elif method not in READS:
        # Nobody reads what a stranger sends, be it JSON or not.
        is_known = OPERATOR in str(headers) or VIEWER in str(headers)
        headers = {**headers, "Content-Type": "application/json"}
        sent = {"content": b"{}" if is_known else b"{"}
    with http.stream(method, path, headers=headers, **sent) as answer:
        if answer.status_code < 400 or method == "HEAD":
            return answer.status_code, ""
        answer.read()
        return answer.status_code, answer.json()["code"]


def close_code(server, path, headers, patience):
    """Return the close code of a WebSocket, 0 when it stays open that long [s]."""
    host = headers.get("Host", f"127.0.0.1:{server.port}")
    others = {name: value for name, value in headers.items() if name != "Host"}
    plain = socket.create_connection(("127.0.0.1", server.port))
    url = f"ws://{host}{path}"
    with connect(url, sock=plain, additional_headers=others, proxy=None) as stream:
        try:
            stream.recv(timeout=patience)
        except ConnectionClosed as closed:
            return closed.rcvd.code
        except TimeoutError:
            pass
    return 0


def wrongly_answered(server, http, routes):
    """Return a line for each caller and route that are not as they must be."""
    for name, caller in CALLERS.items():
        status, code, closed = caller.refusals
        for method, path in routes:
            may = caller.may(method, path)
            if path in LOGINS and name not in {"foreign Origin", "rebound Host"}:
                status, code, may = 401, "unauthorized", False
            else:
                status, code, closed = caller.refusals
            if method == SOCKET:
                # Silence is an answer as well to who may listen.
                patience = 0.3 if may else PATIENCE
                found = close_code(server, path, caller.headers, patience)
                is_refused = found == closed
            else:
                found = refusal(http, method, path, caller.headers)
                is_refused = found in {(status, code), (status, "")}
            if is_refused is may:
                yield f"{name}: {method} {path} was answered {found}"


def test_nobody_gets_in_who_may_not(app):
    routes = list(routes_of(app))
    with (
        ApiServer(app, port=0) as server,
        httpx.Client(base_url=server.url, trust_env=False) as http,
    ):
        found = list(wrongly_answered(server, http, routes))

    assert not found, "\n".join(found)
    assert {method for method, _ in routes} >= {"GET", "POST", "PUT", "DELETE", SOCKET}
    assert len(routes) > 120


def test_a_revoked_token_with_an_open_socket():
    app = create_app(make_station(), Authenticator(OPERATOR, VIEWER))
    named = app.state.services.authenticator.named
    secret = asyncio.run(named.create("eve", "operator", None))
    with (
        ApiServer(app, port=0) as server,
        httpx.Client(base_url=server.url, trust_env=False) as client,
        open_stream(server, "loop", bearer(secret)) as stream,
    ):
        stream.recv(timeout=PATIENCE)
        headers = bearer(OPERATOR)
        client.delete("/api/v1/tokens/eve", headers=headers).raise_for_status()
        with pytest.raises(ConnectionClosed) as closed:
            list(stream)
        answer = client.post("/api/v1/stop", headers=bearer(secret))

    assert closed.value.rcvd.code == 4401
    assert answer.status_code == 401
