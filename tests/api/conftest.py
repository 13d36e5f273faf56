"""A station with one joint, stepped by hand, and ways to talk to it without a net."""

import asyncio

import httpx
import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.client import StationClient
from tests.api.spring import make_station

OPERATOR = "operator-token"
VIEWER = "viewer-token"
URL = "http://127.0.0.1:8000"


class AppTransport(httpx.BaseTransport):
    """Carries each request to an app in an event loop of its own.

    A refusal that the document of the API does not have at its route fails the test.
    """

    def __init__(self, app):
        self._app = app
        self._inner = httpx.ASGITransport(self._noting, raise_app_exceptions=False)

    async def _noting(self, scope, receive, send):
        self._scope = scope
        await self._app(scope, receive, send)

    def handle_request(self, request):
        """Return the app's answer."""
        return asyncio.run(self._answer(request))

    async def _answer(self, request):
        content = b"".join(request.stream)
        request = httpx.Request(
            request.method, request.url, headers=request.headers, content=content
        )
        answer = await self._inner.handle_async_request(request)
        route, status = self._scope.get("route"), answer.status_code
        if getattr(route, "include_in_schema", False) and 400 <= status < 500:
            documented = {405, 412, 423, *route.responses}  # three at every route
            assert status in documented, route.path
        content = b"".join([part async for part in answer.aiter_raw()])
        return httpx.Response(
            answer.status_code, headers=answer.headers, content=content
        )


@pytest.fixture
def station():
    """Return a station that has run one cycle."""
    station = make_station()
    station.loop.step()
    return station


@pytest.fixture
def authenticator():
    """Return an authenticator with known tokens."""
    return Authenticator(OPERATOR, VIEWER)


@pytest.fixture
def app(station, authenticator):
    """Return the app over the station."""
    return create_app(station, authenticator)


@pytest.fixture
def http(app):
    """Return a plain HTTP client without credentials."""
    with httpx.Client(transport=AppTransport(app), base_url=URL) as client:
        yield client


@pytest.fixture
def operator(http):
    """Return the same client with the operator's token."""
    http.headers["Authorization"] = f"Bearer {OPERATOR}"
    return http


@pytest.fixture
def client(app):
    """Return the station's own client as an operator."""
    with StationClient(URL, OPERATOR, transport=AppTransport(app)) as client:
        yield client


@pytest.fixture
def spring(client):
    """Return a client of a station whose controller `spring` runs."""
    client.load_controller("spring", "test/Spring", {"joint": "j", "k": 2.0})
    client.switch_controllers(start=["spring"])
    return client


@pytest.fixture
def server(app):
    """Serve the app on a free port."""
    with ApiServer(app, port=0) as server:
        yield server


@pytest.fixture
def live(server):
    """Return an operator's client of the served station."""
    with StationClient(server.url, OPERATOR) as client:
        yield client
