"""Browser sessions of the gateway."""

import asyncio

from station.ui import sessions as module
from station.ui.sessions import SESSION_LIFETIME, Role, Sessions


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
        await asyncio.wait_for(waiting, 5.0)

    asyncio.run(wait(lambda session: sessions.close(session.identifier)))
    asyncio.run(wait(lambda _: sessions.open(Role.VIEWER)))
    asyncio.run(wait(lambda _: setattr(time, "now", time.now + 2 * SESSION_LIFETIME)))
