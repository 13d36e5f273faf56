"""Browser sessions of the gateway."""

import asyncio

from station.ui.sessions import sessions as module
from station.ui.sessions.sessions import SESSION_LIFETIME, Role, Sessions
from tests.waiting import PATIENCE


class _Time:
    now = 0.0

    def __call__(self):
        return self.now


def test_a_session_is_found_by_its_cookie():
    sessions = Sessions()
    opened = sessions.open(Role.OPERATOR)
    assert sessions.find(opened.identifier) == opened


def test_unknown_cookies_have_no_session():
    sessions = Sessions()
    sessions.open(Role.OPERATOR)
    assert sessions.find("guess") is None
    assert sessions.find(None) is None


def test_a_closed_session_is_forgotten():
    sessions = Sessions()
    opened = sessions.open(Role.VIEWER)
    sessions.close(opened.identifier)
    assert sessions.find(opened.identifier) is None


def test_an_unused_session_expires_and_a_used_one_lives():
    time = _Time()
    sessions = Sessions(time)
    used, unused = sessions.open(Role.VIEWER), sessions.open(Role.VIEWER)
    time.now = 0.9 * SESSION_LIFETIME
    sessions.find(used.identifier)
    time.now = 1.5 * SESSION_LIFETIME
    assert sessions.find(used.identifier) == used
    assert sessions.find(unused.identifier) is None


def test_the_oldest_session_makes_room():
    sessions = Sessions(limit=2)
    first = sessions.open(Role.VIEWER)
    others = [sessions.open(Role.VIEWER) for _ in range(2)]
    assert sessions.find(first.identifier) is None
    assert all(sessions.find(other.identifier) for other in others)


def test_viewers_do_not_displace_operators():
    sessions = Sessions(limit=2)
    operator = sessions.open(Role.OPERATOR)
    for _ in range(5):
        sessions.open(Role.VIEWER)
    assert sessions.find(operator.identifier) == operator


def test_waiting_ends_when_the_session_is_closed_dropped_or_expired(monkeypatch):
    monkeypatch.setattr(module, "EXPIRY_PERIOD", 0.001)
    time = _Time()
    sessions = Sessions(time, limit=1)

    async def wait(end):
        session = sessions.open(Role.VIEWER)
        waiting = asyncio.create_task(sessions.wait_for_end(session))
        await asyncio.sleep(0)
        assert not waiting.done()
        end(session)
        await asyncio.wait_for(waiting, PATIENCE)

    asyncio.run(wait(lambda session: sessions.close(session.identifier)))
    asyncio.run(wait(lambda _: sessions.open(Role.VIEWER)))
    asyncio.run(wait(lambda _: setattr(time, "now", time.now + 2 * SESSION_LIFETIME)))


class _Store:
    """Keeps sessions in memory."""

    def __init__(self):
        self.kept = []
        self.station = "first"

    def load(self):
        return self.kept

    def save(self, sessions):
        self.kept = list(sessions)

    def move_to(self, station):
        self.station = station


def test_sessions_outlive_a_dashboard():
    time, store = _Time(), _Store()
    before = Sessions(time, store=store)
    opened = before.open(Role.OPERATOR, "named token")
    closed = before.open(Role.VIEWER)
    before.close(closed.identifier)
    after = Sessions(time, store=store)
    found = after.find(opened.identifier)
    assert (found.role, found.token) == (Role.OPERATOR, "named token")
    assert after.find(closed.identifier) is None


def test_a_session_that_expired_while_no_dashboard_ran_is_forgotten():
    time, store = _Time(), _Store()
    opened = Sessions(time, store=store).open(Role.OPERATOR)
    time.now = SESSION_LIFETIME + 1.0
    assert Sessions(time, store=store).find(opened.identifier) is None


def test_it_is_kept_now_and_then_that_a_session_is_used():
    time, store = _Time(), _Store()
    sessions = Sessions(time, store=store)
    opened = sessions.open(Role.OPERATOR)
    time.now = 30.0
    sessions.find(opened.identifier)
    assert store.kept[0].used_at == 0.0
    time.now = 90.0
    sessions.find(opened.identifier)
    assert store.kept[0].used_at == 90.0


def test_sessions_go_on_at_the_station_that_takes_over():
    store = _Store()
    Sessions(store=store).move_to("second")
    assert store.station == "second"


def test_a_session_is_found_by_its_key_without_being_renewed():
    time = _Time()
    sessions = Sessions(time)
    opened = sessions.open(Role.OPERATOR)
    time.now = SESSION_LIFETIME - 1.0
    assert sessions.named(opened.key) is opened
    assert sessions.named("guess") is None
    time.now = SESSION_LIFETIME + 1.0
    assert sessions.find(opened.identifier) is None
