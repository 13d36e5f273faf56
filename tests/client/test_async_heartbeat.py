"""A heartbeat in a task."""

import asyncio

from station.client.async_heartbeat import AsyncHeartbeat
from station.client.errors import ApiError, StationUnreachableError


def test_it_goes_on_without_a_link_and_ends_with_a_refusal():
    refusal = ApiError("no", status=423, code="control_held", remedy="")
    beats = [None, StationUnreachableError("u", OSError()), refusal]

    async def beat():
        outcome = beats.pop(0)
        if outcome is not None:
            raise outcome

    async def live():
        heart = AsyncHeartbeat(beat, 0.0)
        heart.start()
        await heart._task
        await heart.stop()
        return heart.refusal

    assert asyncio.run(live()) is refusal


def test_it_is_stopped():
    async def live():
        heart = AsyncHeartbeat(asyncio.Event().wait, 0.0)
        heart.start()
        await asyncio.sleep(0)
        await heart.stop()
        return heart._task.cancelled()

    assert asyncio.run(live())
