"""Control for an asyncio program."""

import asyncio

import pytest

from station.client import ApiError, AsyncStationClient
from tests.api.conftest import OPERATOR


def test_control_lasts_as_long_as_the_block(served):
    async def work():
        async with (
            AsyncStationClient(served.url, OPERATOR) as ada,
            AsyncStationClient(served.url, OPERATOR) as eve,
        ):
            async with ada.control(owner="Ada") as lease:
                await ada.reset_loop_statistics()
                with pytest.raises(ApiError, match="Ada"):
                    await eve.reset_loop_statistics()
                assert lease.lost is None
            await eve.reset_loop_statistics()

    asyncio.run(work())


def test_a_loss_is_noticed_by_the_heartbeat(served):
    async def work():
        async with (
            AsyncStationClient(served.url, OPERATOR) as ada,
            AsyncStationClient(served.url, OPERATOR) as eve,
            ada.control(owner="Ada", ttl=0.5) as lease,
            eve.control(owner="Eve", force=True),
        ):
            await asyncio.wait_for(lease._heartbeat._task, 5.0)
            return lease.lost

    assert "Eve holds control" in str(asyncio.run(work()))
