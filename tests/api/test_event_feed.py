"""Following the event log over HTTP, without a connection."""

import asyncio

import pytest

from station.api import event_feed
from station.api.errors import ProblemError
from station.api.event_feed import EventFeed
from station.events import EventKind, EventLog, Severity

ALL = ((), Severity.INFO)


async def never():
    await asyncio.Event().wait()


def test_a_follower_gets_old_and_new_events_and_ends():
    async def follow():
        log = EventLog()
        log.record(EventKind.STOP, "old")
        end = asyncio.Event()
        lines = EventFeed(log).follow(0, *ALL, end.wait)
        found = [await anext(lines), await anext(lines)]
        log.record(EventKind.STOP, "new")
        found.append(await anext(lines))
        end.set()
        found += [line async for line in lines]
        return b"".join(found).decode()

    text = asyncio.run(follow())

    assert text.count("id: ") == 2
    assert text.index('"old"') < text.index('"new"')


def test_a_quiet_connection_is_kept_alive(monkeypatch):
    monkeypatch.setattr(event_feed, "KEEP_ALIVE", 0.0)

    async def follow():
        lines = EventFeed(EventLog()).follow(None, *ALL, never)
        found = [await anext(lines) for _ in range(2)]
        await lines.aclose()
        return found

    assert asyncio.run(follow())[1].startswith(b":")


def test_followers_are_limited(monkeypatch):
    monkeypatch.setattr(event_feed, "MOST_FOLLOWERS", 1)

    async def follow():
        feed = EventFeed(EventLog())
        lines = feed.follow(None, *ALL, never)
        await anext(lines)
        with pytest.raises(ProblemError):
            feed.follow(None, *ALL, never)
        await lines.aclose()
        feed.follow(None, *ALL, never)

    asyncio.run(follow())
