"""Something that is done again and again beside an asyncio program."""

import asyncio
from collections.abc import Awaitable, Callable

from station.client.errors import ApiError, StationUnreachableError


class AsyncHeartbeat:
    """Beats in a task until it is stopped, or until the station refuses.

    Args:
        beat: What is done.
        period: Time between two beats [s], > 0.

    Attributes:
        refusal: Why the station refused, which ended the heartbeat; None otherwise.
    """

    def __init__(self, beat: Callable[[], Awaitable[object]], period: float) -> None:
        self._beat = beat
        self._period = period
        self._task: asyncio.Task[None] | None = None
        self.refusal: ApiError | None = None

    def start(self) -> None:
        """Begin; the first beat comes after a period."""
        self._task = asyncio.create_task(self._run())

    async def stop(self) -> None:
        """End; a beat under way is cancelled."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.wait([self._task])

    async def _run(self) -> None:
        while True:
            await asyncio.sleep(self._period)
            try:
                await self._beat()
            except StationUnreachableError:
                continue  # the link may come back before the lease is over
            except ApiError as error:
                self.refusal = error
                return
