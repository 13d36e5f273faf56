"""Server-sent events: let programs and pages follow the event log over HTTP."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Collection

import anyio.to_thread
import orjson

from station.api.errors import ProblemError
from station.events import Event, EventKind, EventLog, Severity

MEDIA_TYPE = "text/event-stream"
MOST_FOLLOWERS = 16
"""Most followers at a time; each keeps a connection."""
KEEP_ALIVE = 15.0
"""Longest silence on a connection before a comment is sent [s]."""
PAGE = 200
"""Most events that are read at once."""


class EventFeed:
    """Lets clients follow the event log. Use it in one event loop only.

    It queues nothing for a client, but reads the events after the client's last one
    from memory or disk. So a slow client misses no event and costs no memory.

    Args:
        log: The event log.
    """

    def __init__(self, log: EventLog) -> None:
        self._log = log
        self._followers = 0

    async def page(
        self,
        since: int | None,
        limit: int,
        kinds: Collection[EventKind],
        severity: Severity,
    ) -> list[Event]:
        """Return events, oldest first; the event loop never waits for the disk.

        Args:
            since: Number of the last event that the client has; None for the newest
                events.
            limit: Most events, >= 1.
            kinds: Kinds of the events; all when empty.
            severity: Least severity of the events.
        """
        if since is not None and self._log.is_in_memory(since):
            return self._log.since(since, limit, kinds, severity)

        def read_disk() -> list[Event]:
            if since is None:
                return self._log.newest(limit, kinds, severity)
            return self._log.since(since, limit, kinds, severity)

        return await anyio.to_thread.run_sync(read_disk)

    def follow(
        self,
        since: int | None,
        kinds: Collection[EventKind],
        severity: Severity,
        end: Callable[[], Awaitable[object]],
    ) -> AsyncIterator[bytes]:
        """Return the lines of a stream that follows the log.

        Args:
            since: Number of the last event that the client has; None for new events
                only.
            kinds: Kinds of the events; all when empty.
            severity: Least severity of the events.
            end: Returns when the stream must end.

        Raises:
            ProblemError: There are too many followers.
        """
        if self._followers >= MOST_FOLLOWERS:
            raise ProblemError(
                503,
                "too_many_streams",
                f"{MOST_FOLLOWERS} clients follow the events already.",
                "End one of them, or ask for the events from time to time.",
                {"Retry-After": "5"},
            )
        self._followers += 1
        first = self._log.newest_id if since is None else since
        return self._lines(first, kinds, severity, end)

    async def _lines(
        self,
        last: int,
        kinds: Collection[EventKind],
        severity: Severity,
        end: Callable[[], Awaitable[object]],
    ) -> AsyncIterator[bytes]:
        loop, news = asyncio.get_running_loop(), asyncio.Event()

        def wake(_: Event) -> None:
            loop.call_soon_threadsafe(news.set)

        stop = self._log.listen(wake)
        ending = asyncio.ensure_future(end())
        try:
            yield b"retry: 1000\n\n"
            while not ending.done():
                news.clear()
                newest = self._log.newest_id
                found = await self.page(last, PAGE, kinds, severity)
                for event in found:
                    last = event.id
                    yield _written(event)
                if len(found) < PAGE:
                    last = max(last, newest)
                    if not await self._wait(news, ending):
                        yield b": the station is there\n\n"
        finally:
            stop()
            ending.cancel()
            self._followers -= 1

    async def _wait(
        self, news: asyncio.Event, ending: "asyncio.Future[object]"
    ) -> bool:
        """Wait for news or the end; return False if neither comes in `KEEP_ALIVE`."""
        waiting: asyncio.Future[object] = asyncio.ensure_future(news.wait())
        ends: set[asyncio.Future[object]] = {waiting, ending}
        done, _ = await asyncio.wait(
            ends, timeout=KEEP_ALIVE, return_when=asyncio.FIRST_COMPLETED
        )
        waiting.cancel()
        return bool(done)


def _written(event: Event) -> bytes:
    text = orjson.dumps(event).decode()
    return f"id: {event.id}\nevent: {event.kind}\ndata: {text}\n\n".encode()
