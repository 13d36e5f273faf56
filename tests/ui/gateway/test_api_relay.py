"""The relay to the station: whose token goes along, and what comes back."""

import asyncio

import httpx
import pytest
from starlette.applications import Starlette
from starlette.responses import JSONResponse
from starlette.routing import Route, WebSocketRoute
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.local.tls import trust
from station.ui.gateway.api_relay import ApiRelay
from station.ui.link.station_access import StationAccess
from station.ui.sessions.session_access import BEGIN_WITHIN, SessionAccess
from station.ui.sessions.sessions import BrowserSession, Role, SessionRoutes
from tests.api.spring import make_station
from tests.certificates import make_certificate
from tests.ui.fake_station import OPERATOR, VIEWER, FakeStation
from tests.ui.served import Served
from tests.waiting import PATIENCE


def _station(url):
    return StationAccess(url, OPERATOR, "", VIEWER)


class _Page:
    """A relay that serves one browser, without the gateway before it."""

    def __init__(self, url, tls=None):
        self.url = url
        self.access = SessionAccess(_station(url))
        self.relay = ApiRelay(self.access, tls)
        self.session = BrowserSession("cookie", Role.OPERATOR, OPERATOR)
        self.logged_out = asyncio.Event()

    async def forward(self, session, request):
        return await self.relay.forward(request, session)

    async def stream(self, socket):
        await self.relay.socket(socket, self.session, self.logged_out.wait)

    def app(self):
        async def close(_):
            await self.relay.close()
            return JSONResponse({})

        def does(act):
            async def answer(_):
                act()
                return JSONResponse({})

            return answer

        station = _station(self.url)
        methods = ["GET", "POST", "PUT", "DELETE"]
        make = SessionRoutes(lambda _: self.session)
        return Starlette(
            routes=[
                Route("/close", close),
                # In the event loop of the gateway, as the dashboard does it.
                Route("/lose", does(lambda: self.access.move_to(None))),
                Route("/find", does(lambda: self.access.move_to(station))),
                Route("/log_out", does(self.logged_out.set)),
                WebSocketRoute("/api/v1/streams/{topic:path}", self.stream),
                *(make.route(m, "/api/v1/{path:path}", self.forward) for m in methods),
            ]
        )


@pytest.fixture(scope="module")
def served():
    with FakeStation() as station:
        page = _Page(station.url)
        with Served(page.app()) as gateway:
            yield station, page, gateway.url
            httpx.get(gateway.url + "/close")


@pytest.fixture(autouse=True)
def page(served):
    served[1].session = BrowserSession("cookie", Role.OPERATOR, OPERATOR)
    return served[1]


@pytest.fixture
def browser(served):
    with httpx.Client(base_url=served[2] + "/api/v1") as client:
        yield client


def _socket(served, topic):
    return connect(
        f"{served[2]}/api/v1/streams/{topic}".replace("http", "ws", 1), proxy=None
    )


def test_requests_reach_the_station_with_body_and_answer(browser, served):
    answer = browser.post("/stop", json={"reason": "test"})
    assert answer.json()["state"] == "stopped"
    assert ("POST", "/api/v1/stop", {"reason": "test"}) in served[0].requests
    assert browser.post("/stop/release", json={"arm": True}).is_success


def test_a_refusal_of_the_station_keeps_its_words(browser, page):
    page.session = BrowserSession("cookie", Role.OPERATOR, "a token of nobody")
    answer = browser.get("/status")
    assert answer.status_code == 401
    assert answer.json()["detail"] == "The token is wrong."


def test_the_browser_cannot_choose_another_token(browser, page):
    page.session = BrowserSession("cookie", Role.OPERATOR, "a token of nobody")
    headers = {"Authorization": f"Bearer {OPERATOR}"}
    assert browser.get("/status", headers=headers).status_code == 401


def test_routes_off_the_list_are_not_forwarded(browser, served):
    before = len(served[0].requests)
    assert browser.get("/session").json()["code"] == "not_forwarded"
    assert len(served[0].requests) == before


def test_viewers_change_nothing(browser, page, served):
    page.session = BrowserSession("cookie", Role.VIEWER, VIEWER)
    before = len(served[0].requests)
    assert browser.post("/controllers/switch", json={}).status_code == 403
    assert len(served[0].requests) == before
    assert browser.get("/status").is_success


def test_a_station_that_is_gone_is_said_to_be(browser, page, served):
    page.access.move_to(_station("http://127.0.0.1:1"))
    try:
        answer = browser.get("/status")
    finally:
        page.access.move_to(_station(served[0].url))
    assert (answer.status_code, answer.json()["code"]) == (502, "unreachable")


def test_who_answers_in_the_place_of_an_ended_station_is_not_asked(
    browser, page, served
):
    before = len(served[0].requests)
    page.access.move_to(None)
    try:
        answer = browser.get("/status")
    finally:
        page.access.move_to(_station(served[0].url))
    assert (answer.status_code, answer.json()["code"]) == (502, "unreachable")
    assert len(served[0].requests) == before


def test_a_stream_waits_for_the_station_and_has_its_frames_without_asking_again(served):
    httpx.get(served[2] + "/lose")
    with _socket(served, "joint_states") as socket:
        with pytest.raises(TimeoutError):
            socket.recv(timeout=0.05)
        httpx.get(served[2] + "/find")
        assert "hello" in socket.recv(timeout=PATIENCE)


def test_a_stream_that_waits_for_the_station_ends_with_its_session(served, page):
    httpx.get(served[2] + "/lose")
    try:
        with _socket(served, "loop") as socket:
            httpx.get(served[2] + "/log_out")
            with pytest.raises(ConnectionClosed) as end:
                socket.recv(timeout=PATIENCE)
    finally:
        httpx.get(served[2] + "/find")
        page.logged_out.clear()
    assert end.value.rcvd.code == 4401


def test_frames_of_a_stream_reach_the_browser(served):
    with _socket(served, "joint_states") as socket:
        assert "hello" in socket.recv(timeout=PATIENCE)


def test_streams_off_the_list_are_closed_with_a_code(served):
    with _socket(served, "secrets") as socket, pytest.raises(ConnectionClosed) as end:
        socket.recv(timeout=PATIENCE)
    assert end.value.rcvd.code == 4404


def test_only_chosen_headers_go_either_way():
    seen = {}

    async def answer(request):
        seen.update(request.headers)
        return JSONResponse({}, headers={"ETag": '"7"', "Set-Cookie": "station=1"})

    route = Route("/api/v1/status", answer)
    with Served(Starlette(routes=[route])) as station:
        page = _Page(station.url)
        with Served(page.app()) as gateway:
            headers = {"Cookie": "dashboard=secret", "If-Match": '"6"'}
            told = httpx.get(gateway.url + "/api/v1/status", headers=headers)
            httpx.get(gateway.url + "/close")
    assert seen["if-match"] == '"6"'
    assert "cookie" not in seen
    assert told.headers["etag"] == '"7"'
    assert "set-cookie" not in told.headers


def test_a_change_is_not_begun_long_after_it_was_asked_for():
    seen = {}

    async def answer(request):
        seen[request.method, request.url.path] = request.headers.get("x-not-after")
        return JSONResponse({}, headers={"X-Station-Clock": "1000.0"})

    route = Route("/api/v1/{path:path}", answer, methods=["GET", "POST", "DELETE"])
    with Served(Starlette(routes=[route])) as station:
        page = _Page(station.url)
        with Served(page.app()) as gateway:
            at = gateway.url + "/api/v1"
            httpx.get(f"{at}/status")
            httpx.post(f"{at}/controllers/switch")
            httpx.delete(f"{at}/playback")  # An end is right however late it comes.
            httpx.get(gateway.url + "/close")
    late = float(seen.pop(("POST", "/api/v1/controllers/switch"))) - 1000.0
    assert BEGIN_WITHIN <= late < BEGIN_WITHIN + PATIENCE
    assert set(seen.values()) == {None}


def test_a_station_with_tls_is_asked_if_its_certificate_is_trusted(tmp_path):
    tls = make_certificate(tmp_path)
    app = create_app(make_station(), Authenticator(OPERATOR, VIEWER))
    with ApiServer(app, port=0, tls=tls) as server:
        for trusted, status in ((trust(server.url, tls.certificate), 200), (None, 502)):
            page = _Page(server.url, trusted)
            with Served(page.app()) as gateway:
                answer = httpx.get(f"{gateway.url}/api/v1/status")
                httpx.get(gateway.url + "/close")
            assert answer.status_code == status
