"""Control from the page: taken, kept, offered, given back; the lease stays inside."""

import asyncio

import httpx
import pytest
from starlette.applications import Starlette

from station.client import ApiError, StationUnreachableError
from station.ui.link.station_access import StationAccess
from station.ui.page.workspace_routes import ControlRoutes
from station.ui.sessions.session_access import SessionAccess
from station.ui.sessions.sessions import BrowserSession, Role
from station.wire import ControlState
from tests.ui.served import Served

PATH = "/workspace/control"
MINE = ControlState(
    owner="ada", mine=True, lease="secret-key", ttl=10.0, expires_in=10.0
)
HELD = ApiError("Bob holds control.", status=423, code="control_held", remedy="Wait.")


class _Client:
    """Stands for the station's client."""

    def __init__(self):
        self.asked = []
        self.refusal = None

    @property
    def lease(self):
        return self

    async def __aenter__(self):
        return self

    async def __aexit__(self, *_):
        return None

    def _told(self, *asked):
        self.asked.append(asked)
        if self.refusal is not None:
            raise self.refusal
        return ControlState() if asked[0] == "release" else MINE

    async def state(self):
        return self._told("show")

    async def take(self, owner, *, ttl, force):
        return self._told("take", owner, ttl, force)

    async def renew(self, *, hand_over_to=None):
        return self._told("renew", hand_over_to)

    async def release(self):
        return self._told("release")


class _Access(SessionAccess):
    """The credentials, with clients that only remember."""

    def __init__(self):
        super().__init__(StationAccess("http://station", "token", ""))
        self.client = _Client()

    def acting_for(self, session):
        assert session is not None
        return self.client


class _Bench:
    def __init__(self):
        self.access = _Access()
        self.session = BrowserSession("a", Role.OPERATOR)
        self.control = ControlRoutes(self.access, lambda _: self.session)

    def lease(self):
        return self.access.lease_of(self.session)


@pytest.fixture
def bench():
    return _Bench()


@pytest.fixture
def browser(bench):
    with (
        Served(Starlette(routes=bench.control.routes())) as served,
        httpx.Client(base_url=served.url) as client,
    ):
        yield client


def test_control_is_taken_offered_and_given_back(browser, bench):
    assert browser.post(PATH, json={"owner": "ada"}).json()["mine"]
    assert bench.lease() == "secret-key"
    assert browser.patch(PATH, json={"hand_over_to": "bob"}).is_success
    assert browser.delete(PATH).json()["owner"] is None
    assert bench.lease() is None
    assert bench.access.client.asked == [
        ("take", "ada", 10.0, False),
        ("renew", "bob"),
        ("release",),
    ]


def test_no_answer_has_the_lease_in_it(browser):
    answers = [
        browser.get(PATH),
        browser.post(PATH, json={"owner": "", "force": True}),
        browser.patch(PATH, json={"hand_over_to": "bob"}),
    ]
    assert all(answer.is_success for answer in answers)
    assert not any("lease" in answer.text for answer in answers)
    assert not any("secret-key" in answer.text for answer in answers)


def test_a_refusal_keeps_the_stations_words(browser, bench):
    bench.access.client.refusal = HELD
    answer = browser.post(PATH, json={"owner": "ada"})
    assert (answer.status_code, answer.json()["code"]) == (423, "control_held")
    assert answer.json()["detail"] == "Bob holds control."
    assert bench.lease() is None


@pytest.mark.parametrize("method", ["POST", "PATCH", "DELETE"])
def test_viewers_look_and_take_nothing(browser, bench, method):
    bench.session = BrowserSession("v", Role.VIEWER)
    body = {"PATCH": {"hand_over_to": "x"}}.get(method, {})
    assert browser.request(method, PATH, json=body).status_code == 403
    assert bench.access.client.asked == []
    assert browser.get(PATH).is_success


def test_strangers_are_told_nothing(browser, bench):
    bench.session = None
    assert browser.get(PATH).status_code == 401


@pytest.mark.parametrize(
    ("method", "body"),
    [
        ("POST", {"force": 1}),
        ("POST", {"owner": "x" * 101}),
        ("POST", {"lease": "x"}),
        ("PATCH", {}),
    ],
)
def test_what_is_malformed_is_refused(browser, bench, method, body):
    assert browser.request(method, PATH, json=body).status_code == 422
    assert bench.access.client.asked == []


def test_heartbeats_are_sent_by_the_holder_alone(bench):
    asyncio.run(bench.control.beat(bench.session))
    assert bench.access.client.asked == []
    bench.access.note(bench.session, MINE, None, 1e12)
    asyncio.run(bench.control.beat(bench.session))
    assert bench.access.client.asked == [("renew", None)]


@pytest.mark.parametrize(
    ("failure", "kept"),
    [(HELD, None), (StationUnreachableError("http://x", OSError("x")), "secret-key")],
)
def test_a_refused_heartbeat_ends_it_and_a_lost_one_does_not(bench, failure, kept):
    bench.access.note(bench.session, MINE, None, 1e12)
    bench.access.client.refusal = failure
    asyncio.run(bench.control.beat(bench.session))
    assert bench.lease() == kept
