"""Every method of the client for asyncio, against a served station."""

import asyncio

import pytest

from station.client import ApiError, AsyncStationClient, StationUnreachableError
from tests.api.conftest import OPERATOR


async def everything(client, station):
    await client.health()
    assert (await client.status()).cycle == 1
    await client.load_controller("spring", "test/Spring", {"joint": "j"})
    assert (await client.switch_controllers(start=["spring"])).started == ["spring"]
    assert [c.name for c in await client.controllers()] == ["spring"]
    assert (await client.controller("spring")).state == "running"
    etag = (await client.gains("spring")).etag
    assert (await client.set_gains("spring", {"k": 2}, etag)).values == {"k": 2.0}
    assert (await client.command("spring", [0.5], epoch=1)).epoch == 1
    station.loop.step()
    assert (await client.last_command("spring")).last == [0.5]
    assert (await client.controller_state("spring")).desired == [0.5]
    assert (await client.joint_states()).name == ["j"]
    assert len(await client.controller_types()) == 1
    assert (await client.loop()).cycles == station.loop.cycle
    assert (await client.reset_loop_statistics()).cycles == 0
    assert (await client.stop("x")).state == "stopped"
    assert (await client.stop_state()).reason == "x"
    assert (await client.release_stop()).state == "released"
    assert (await client.release_stop(arm=True)).state == "armed"
    assert (await client.unload_controller("spring")).name == "spring"
    assert (await client.stream_ticket()).ticket
    with pytest.raises(ApiError, match="not running"):
        await client.ready()


def test_every_method(served, station):
    async def run():
        async with AsyncStationClient(served.url, OPERATOR) as client:
            await everything(client, station)

    asyncio.run(run())


def test_nobody_there_is_said_plainly():
    async def run():
        async with AsyncStationClient("http://127.0.0.1:9", timeout=1.0) as client:
            await client.health()

    with pytest.raises(StationUnreachableError, match=r"127\.0\.0\.1:9"):
        asyncio.run(run())
