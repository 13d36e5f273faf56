"""What ends a socket, and what of it is told."""

import asyncio

import pytest

from station.ui.socket_ends import until_first


async def _fail():
    raise LookupError("a page without a name")


async def _serve(first):
    forever = asyncio.create_task(asyncio.Event().wait())
    await until_first(asyncio.create_task(first), forever)
    return forever


def test_the_first_end_ends_all():
    assert asyncio.run(_serve(asyncio.sleep(0))).cancelled()


def test_a_failure_is_not_swallowed():
    with pytest.raises(LookupError, match="without a name"):
        asyncio.run(_serve(_fail()))


def test_whoever_waits_may_be_cancelled():
    async def cancelled():
        waiting = asyncio.Event()
        inner = asyncio.create_task(waiting.wait())
        outer = asyncio.create_task(until_first(inner))
        await asyncio.sleep(0)
        outer.cancel()
        await asyncio.gather(outer, return_exceptions=True)
        return inner.cancelled()

    assert asyncio.run(cancelled())
