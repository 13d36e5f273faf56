"""The gateway: nothing is shown or done before login, by strangers or by viewers."""

import asyncio
import os
import socket

import httpx
import pytest
from starlette.applications import Starlette
from starlette.responses import JSONResponse, PlainTextResponse
from starlette.routing import Route
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from station.client import ApiError, AsyncStationClient, StationUnreachableError
from station.ui.gateway import gateway as gateway_module
from station.ui.gateway.gateway import GatewayParts, StopButton, build_gateway
from station.ui.gateway.guard import origin_policy
from station.ui.link.station_access import StationAccess
from station.ui.link.station_view import StationView
from station.ui.page.page_state import BarState
from station.ui.page.view_routes import ShownViews
from station.ui.page.workspace_routes import WorkspaceParts
from station.ui.scene.scene_views import SceneViews
from station.ui.sessions.session_access import SessionAccess
from station.ui.sessions.sessions import Role, Sessions
from station.web.failed_logins import FailedLogins
from station.wire import StopState
from tests.ui.served import Served
from tests.waiting import PATIENCE

ROLES = {"good": Role.OPERATOR, "watch": Role.VIEWER}
START = StationAccess("http://station", "of the start", "")
ACCESS = SessionAccess(START)


class _Relay:
    """Stands for Viser."""

    async def page(self):
        return PlainTextResponse("viser")

    async def socket(self, browser, _key, role_now, wait_for_end):
        role = role_now()
        await browser.accept()
        await browser.send_text(role.value)
        if role is Role.VIEWER:
            await wait_for_end()
        await browser.close(4321, "done")


class _Api:
    """Stands for the way to the station's API; says whose credential it would add."""

    async def forward(self, request, session):
        if request.url.path.endswith("/loop"):
            return PlainTextResponse("who are you?", 401)
        return PlainTextResponse(f"{request.method} {session.token}")

    async def socket(self, browser, session, wait_for_end):
        await browser.accept()
        await browser.send_text(session.token)
        await wait_for_end()
        await browser.close(4401, "done")


class _Station:
    def __init__(self):
        self.done = []
        self.failure = None
        self.link = "live"
        self.slept = []

    async def sleep(self, delay):
        self.slept.append(delay)

    async def role_of(self, token):
        if self.failure:
            raise self.failure
        return ROLES.get(token)

    async def stop(self):
        if self.failure:
            raise self.failure
        self.done.append("stop")
        return StopState(state="stopped", reason="", epoch=2)

    async def release(self, session, *, arm):
        assert session.role is Role.OPERATOR
        self.done.append(("release", arm))
        return StopState(state="armed" if arm else "released", reason="", epoch=3)


@pytest.fixture(scope="module")
def gateway():
    station = _Station()
    app = build_gateway(
        GatewayParts(
            role_of=station.role_of,
            stop=station.stop,
            release=station.release,
            bar=lambda: BarState(station.link, 0.1, mode="idle"),
            relay=_Relay(),
            api=_Api(),
            workspace=WorkspaceParts(StationView, ACCESS),
            views=ShownViews(
                SceneViews((), lambda _: "", None, tuple), lambda call: call()
            ),
            origins=origin_policy("127.0.0.1"),
            sessions=Sessions(),
            failed_logins=FailedLogins(sleep=station.sleep),
        )
    )
    with Served(app) as served:
        yield served.url, station


@pytest.fixture(autouse=True)
def station(gateway):
    """The station, as if nobody had touched it."""
    gateway[1].__init__()
    return gateway[1]


@pytest.fixture
def browser(gateway):
    """A browser without cookies."""
    with httpx.Client(base_url=gateway[0]) as client:
        yield client


def _own(browser):
    """Return the headers of the dashboard's own pages."""
    return {"Origin": str(browser.base_url).rstrip("/")}


def _socket(browser, origin=None, path="/ui"):
    url = str(browser.base_url.copy_with(scheme="ws", path=path))
    cookies = "; ".join(f"{key}={value}" for key, value in browser.cookies.items())
    return connect(
        url,
        origin=origin or _own(browser)["Origin"],
        additional_headers={"Cookie": cookies},
        proxy=None,
    )


def _log_in(browser, token="good"):
    return browser.post("/login", data={"token": token}, headers=_own(browser))


@pytest.mark.parametrize("path", ["/", "/ui/"])
def test_pages_lead_to_the_login(browser, path):
    answer = browser.get(path)
    assert (answer.status_code, answer.headers["location"]) == (303, "/login")


@pytest.mark.parametrize("path", ["/state", "/session", "/api/v1/status"])
def test_data_needs_a_session(browser, path):
    assert browser.get(path).status_code == 401


@pytest.mark.parametrize("path", ["/stop", "/release", "/arm", "/api/v1/stop"])
def test_nothing_is_done_without_a_session(browser, station, path):
    assert browser.post(path, headers=_own(browser)).status_code == 401
    assert station.done == []


def test_socket_needs_a_session(browser):
    with pytest.raises(InvalidStatus, match="403"), _socket(browser):
        pass


def test_login_sets_a_strict_cookie_that_is_not_the_token(browser):
    cookie = _log_in(browser).headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=strict" in cookie
    assert "good" not in cookie


def test_the_login_page_leads_whoever_is_logged_in_to_the_dashboard(browser):
    assert browser.head("/login").status_code == 200
    _log_in(browser)
    answer = browser.head("/login")
    assert (answer.status_code, answer.headers["location"]) == (303, "/")


def test_login_by_link_takes_the_token_out_of_the_address(browser):
    answer = browser.get("/login?token=good")
    assert (answer.status_code, answer.headers["location"]) == (303, "/")
    assert browser.get("/").status_code == 200


def test_a_wrong_token_opens_nothing(browser):
    answer = _log_in(browser, "wrong")
    assert answer.headers["location"] == "/login?refused=token"
    assert "set-cookie" not in answer.headers


def test_login_says_when_the_station_does_not_answer(browser, station):
    station.failure = StationUnreachableError("http://x", OSError("down"))
    assert _log_in(browser).headers["location"] == "/login?refused=link"


def test_logout_ends_the_session(browser):
    _log_in(browser)
    browser.post("/logout", headers=_own(browser))
    assert browser.get("/state").status_code == 401


def test_state_has_the_bar_and_the_role(browser):
    _log_in(browser, "watch")
    state = browser.get("/state").json()
    assert (state["link"], state["mode"], state["role"]) == ("live", "idle", "viewer")


@pytest.mark.parametrize("token", ["good", "watch"])
def test_everybody_logged_in_can_stop(browser, station, token):
    _log_in(browser, token)
    answer = browser.post("/stop", headers=_own(browser))
    assert answer.json() == {"state": "stopped", "epoch": 2}
    assert station.done == ["stop"]


def test_an_unconfirmed_stop_is_said_to_be_one(browser, station):
    _log_in(browser)
    station.failure = ApiError("Not now.", status=503, code="loop", remedy="Wait.")
    answer = browser.post("/stop", headers=_own(browser))
    assert answer.status_code == 503
    told = {"code": "loop", "detail": "Not now.", "remedy": "Wait."}
    assert answer.json() == {"status": 503, **told}


def test_viewers_cannot_release(browser, station):
    _log_in(browser, "watch")
    for path in ("/release", "/arm"):
        assert browser.post(path, headers=_own(browser)).status_code == 403
    assert station.done == []


def test_operators_release_in_two_steps(browser, station):
    _log_in(browser)
    for path in ("/release", "/arm"):
        assert browser.post(path, headers=_own(browser)).status_code == 200
    assert station.done == [("release", False), ("release", True)]


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null"])
def test_foreign_pages_can_do_nothing(browser, station, origin):
    _log_in(browser)
    headers = {} if origin is None else {"Origin": origin}
    assert browser.post("/stop", headers=headers).status_code == 403
    assert station.done == []


def test_the_api_is_asked_with_the_credential_of_the_session(browser):
    _log_in(browser, "watch")
    assert browser.get("/api/v1/status").text == "GET watch"
    with _socket(browser, path="/api/v1/streams/loop") as socket:
        assert socket.recv() == "watch"
        browser.post("/logout", headers=_own(browser))
        with pytest.raises(ConnectionClosed) as closed:
            socket.recv(timeout=PATIENCE)
    assert closed.value.rcvd.code == 4401


def test_all_but_a_stop_is_refused_at_once_while_the_station_is_lost(browser, station):
    _log_in(browser)
    station.link = "lost"
    refused = browser.get("/api/v1/status")
    assert (refused.status_code, refused.json()["code"]) == (502, "unreachable")
    own = _own(browser)
    for path in ("/api/v1/controllers/switch", "/release", "/arm"):
        refused = browser.post(path, headers=own)
        assert (refused.status_code, refused.json()["code"]) == (502, "unreachable")
    assert browser.post("/api/v1/stop", headers=own).text.startswith("POST")
    assert browser.post("/stop", headers=own).status_code == 200


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null"])
def test_foreign_pages_reach_no_route_of_the_api(browser, origin):
    _log_in(browser)
    headers = {} if origin is None else {"Origin": origin}
    assert browser.put("/api/v1/x", headers=headers).status_code == 403


@pytest.mark.parametrize("path", ["/workspace/teleoperation", "/api/v1/streams/loop"])
def test_foreign_pages_get_no_stream_and_no_desk(browser, path):
    _log_in(browser)
    with (
        pytest.raises(InvalidStatus, match="403"),
        _socket(browser, "http://evil.example", path),
    ):
        pass


def test_a_trajectory_may_be_larger_than_the_login_form(browser):
    _log_in(browser)
    for size, status in ((100_000, 200), (300_000, 413)):
        answer = browser.put("/api/v1/x", content=b"x" * size, headers=_own(browser))
        assert answer.status_code == status


def test_foreign_pages_get_no_socket(browser):
    _log_in(browser)
    with (
        pytest.raises(InvalidStatus, match="403"),
        _socket(browser, "http://evil.example"),
    ):
        pass


def test_a_rebound_host_is_not_answered(browser):
    assert browser.get("/login", headers={"Host": "evil.example"}).status_code == 403
    assert (
        browser.get("/", headers={"Origin": "http://evil.example"}).status_code == 403
    )


def test_close_codes_reach_the_browser(browser):
    _log_in(browser)
    with _socket(browser) as socket:
        assert socket.recv() == "operator"
        with pytest.raises(ConnectionClosed) as closed:
            socket.recv()
    assert closed.value.rcvd.code == 4321


@pytest.mark.parametrize("query", ["websocket=ws://evil.example", "playbackPath=//x"])
def test_viser_is_not_sent_elsewhere(browser, query):
    _log_in(browser)
    answer = browser.get(f"/ui/?{query}")
    assert (answer.status_code, answer.headers["location"]) == (303, "/ui/")


@pytest.mark.parametrize("path", ["/", "/login", "/ui/", "/state"])
def test_every_answer_is_sealed(browser, path):
    _log_in(browser)
    headers = browser.get(path).headers
    assert headers["cache-control"] == "no-store"
    assert "connect-src 'self'" in headers["content-security-policy"]
    assert headers["referrer-policy"] == "same-origin"


@pytest.mark.parametrize(
    "name", ["page.css", "page.js", "lib/dom.js", "vendor/lit/directives/repeat.js"]
)
def test_static_files_are_served(browser, name):
    assert browser.get(f"/static/{name}").status_code == 200


def test_a_script_that_a_browser_has_is_not_sent_again(browser):
    first = browser.get("/static/lib/dom.js")
    assert first.headers["cache-control"] == "no-cache"
    tag = first.headers["etag"]
    for known in (tag, f'W/{tag}, "of another"'):
        again = browser.get("/static/lib/dom.js", headers={"If-None-Match": known})
        assert (again.status_code, again.content) == (304, b"")
        assert (again.headers["etag"], again.headers["cache-control"]) == (
            tag,
            "no-cache",
        )
        assert again.headers["x-content-type-options"] == "nosniff"
    other = {"If-None-Match": browser.get("/static/page.js").headers["etag"]}
    assert browser.get("/static/lib/dom.js", headers=other).content == first.content


def test_a_script_is_sent_anew_after_an_upgrade(browser, tmp_path, monkeypatch):
    script = tmp_path / "page.js"
    script.write_text("before();")
    monkeypatch.setattr(gateway_module, "_STATIC", tmp_path)
    known = {"If-None-Match": browser.get("/static/page.js").headers["etag"]}
    assert browser.get("/static/page.js", headers=known).status_code == 304
    # Packages may install files of one size and one time of change.
    times = (script.stat().st_atime_ns, script.stat().st_mtime_ns)
    script.write_text("after_();")
    os.utime(script, ns=times)
    answer = browser.get("/static/page.js", headers=known)
    assert (answer.status_code, answer.text) == (200, "after_();")


@pytest.mark.parametrize(
    "name", ["page.html", "package.json", "..%2Fmain.py", "x", "lib"]
)
def test_other_files_are_not(browser, name):
    assert browser.get(f"/static/{name}").status_code == 404


def test_a_huge_form_is_refused(browser):
    body = httpx.QueryParams({"token": "x" * 10_000})
    answer = browser.post("/login", content=str(body).encode(), headers=_own(browser))
    assert answer.status_code == 413


def test_logging_out_ends_the_socket_of_that_session_alone(browser, gateway):
    _log_in(browser, "watch")
    with httpx.Client(base_url=gateway[0]) as other:
        _log_in(other, "watch")
        with _socket(browser) as mine, _socket(other) as kept:
            assert mine.recv() == kept.recv() == "viewer"

            browser.post("/logout", headers=_own(browser))

            with pytest.raises(ConnectionClosed):
                mine.recv(timeout=PATIENCE)
            with pytest.raises(TimeoutError):
                kept.recv(timeout=0.1)
            other.post("/logout", headers=_own(other))
            with pytest.raises(ConnectionClosed):
                kept.recv(timeout=PATIENCE)


def test_wrong_tokens_are_held_back_and_right_ones_are_not(browser, station):
    for _ in range(12):
        _log_in(browser, "wrong")
    assert max(station.slept) == 1.0
    station.slept.clear()

    assert _log_in(browser).headers["location"] == "/"
    assert station.slept == []


def test_a_body_is_refused_before_it_arrives(browser):
    url = browser.base_url
    head = (
        f"POST /login HTTP/1.1\r\nHost: {url.host}:{url.port}\r\n"
        f"Origin: {_own(browser)['Origin']}\r\n"
    )
    with socket.create_connection((url.host, url.port), timeout=PATIENCE) as raw:
        raw.sendall(f"{head}Content-Length: 398458880\r\n\r\n".encode())
        assert raw.recv(65536).startswith(b"HTTP/1.1 413")


def test_a_body_without_a_length_is_refused_when_it_grows_too_large(browser):
    parts = iter([b"token=" + b"x" * 3000, b"x" * 3000])
    answer = browser.post("/login", content=parts, headers=_own(browser))
    assert answer.status_code == 413


def test_a_refusal_while_the_station_is_started_anew_ends_no_session(browser):
    _log_in(browser)
    ACCESS.move_to(None)
    try:
        assert browser.get("/api/v1/loop").status_code == 401
    finally:
        ACCESS.move_to(START)
    assert browser.get("/session").status_code == 200


def test_a_session_that_the_station_does_not_know_any_more_ends(browser):
    _log_in(browser)
    assert browser.get("/api/v1/loop").status_code == 401
    assert browser.get("/session").status_code == 401


NOBODY = "http://127.0.0.1:9"


class FakeApi:
    """A station that answers a stop as it is told to."""

    url = NOBODY

    def __init__(self, *, pending=False, hangs=False):
        self._pending, self._hangs = pending, hangs

    async def stop(self, _):
        if self._hangs:
            await asyncio.sleep(600.0)
        return StopState(state="stopped", reason="", epoch=7, pending=self._pending)


@pytest.fixture
def watchdog():
    """Return a served watchdog that keeps the tokens it was shown."""
    tokens = []

    async def stop(request):
        tokens.append(request.headers["authorization"])
        return JSONResponse({"state": "stopped", "carried_out": False, "detail": "Ok."})

    with Served(Starlette(routes=[Route("/stop", stop, methods=["POST"])])) as served:
        served.tokens = tokens
        yield served


def press(api, url):
    return asyncio.run(StopButton(api, "secret", url).press())


def test_a_station_that_answers_is_believed(watchdog):
    assert press(FakeApi(), watchdog.url).epoch == 7
    assert watchdog.tokens == []


@pytest.mark.parametrize("trouble", [{"hangs": True}, {"pending": True}])
def test_a_station_that_hangs_is_stopped_through_the_watchdog(watchdog, trouble):
    state = press(FakeApi(**trouble), watchdog.url)

    assert (state.state, state.pending, state.reason) == ("stopped", True, "Ok.")
    assert watchdog.tokens == ["Bearer secret"]


def test_a_station_that_is_gone_is_stopped_through_the_watchdog(watchdog):
    async def run():
        async with AsyncStationClient(NOBODY, "secret") as api:
            button = StopButton(api, "old", NOBODY)
            button.move_to("new", watchdog.url)
            return await button.press()

    assert asyncio.run(run()).state == "stopped"
    assert watchdog.tokens == ["Bearer new"]


def test_an_unconfirmed_stop_is_an_error():
    with pytest.raises(StationUnreachableError):
        press(FakeApi(hangs=True), NOBODY)


def test_without_a_watchdog_the_stations_answer_counts():
    assert press(FakeApi(pending=True), "").pending
