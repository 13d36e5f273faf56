"""The stream for asyncio: frames, reconnection, refusals."""

import asyncio

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.client import (
    ApiError,
    AsyncStationClient,
    StationUnreachableError,
    StreamTimeoutError,
    stream_options,
)
from tests.api.conftest import OPERATOR
from tests.api.spring import make_station
from tests.franka_station import make_franka_station


def run_with(served, check, token=OPERATOR):
    async def run():
        async with AsyncStationClient(served.url, token) as client:
            return await check(client)

    return asyncio.run(run())


def test_frames_come_without_the_hello(served, station):
    async def check(client):
        stream = client.stream("joint_states", rate=100, fields=["position"])
        async for frame in stream:
            assert stream.progress.connected
            return frame
        return None

    frame = run_with(served, check)
    assert frame.topic == "joint_states"
    assert frame.data == {"position": [0.25]}
    assert frame.boot_id == station.boot_id


def test_whole_state_of_an_arm_is_streamed():
    async def check(client):
        async for frame in client.stream("robot_state", rate=50):
            return frame
        return None

    app = create_app(make_franka_station(), Authenticator(OPERATOR))
    with ApiServer(app, port=0) as server:
        frame = run_with(server, check)

    assert frame.topic == "robot_state/panda"
    assert (frame.data["robot_mode"], len(frame.data["O_T_EE"])) == ("idle", 16)


def test_a_refusal_is_raised_not_retried(served):
    async def check(client):
        async for _ in client.stream("loop"):
            pass

    with pytest.raises(ApiError) as caught:
        run_with(served, check, token="wrong")
    assert caught.value.status == 4401


def test_without_reconnection_a_broken_link_is_an_error(served):
    async def check(client):
        async for _ in client.stream("joint_states", reconnect=False):
            await asyncio.to_thread(served.stop)

    with pytest.raises(StationUnreachableError):
        run_with(served, check)


def test_a_stream_survives_a_restart_of_the_station(served, monkeypatch):
    monkeypatch.setattr(stream_options, "FIRST_DELAY", 0.01)
    other = make_station()
    other.loop.step()
    port = served.port
    successor = ApiServer(create_app(other, Authenticator(OPERATOR)), port=port)

    async def check(client):
        stream = client.stream("joint_states")
        async for frame in stream:
            if frame.boot_id == other.boot_id:
                return stream.progress.connections
            await asyncio.to_thread(served.stop)
            await asyncio.to_thread(successor.start)
        return None

    try:
        assert run_with(served, check) == 2
    finally:
        successor.stop()


def test_entering_connects_at_once_or_raises(served):
    async def check(client):
        async with client.stream("joint_states") as stream:
            assert stream.progress.connected
        assert not stream.progress.connected
        async with client.stream("nothing"):
            pass

    with pytest.raises(ApiError, match="No topic 'nothing'"):
        run_with(served, check)


def test_frame_that_fulfils_a_condition_is_waited_for(served, station):
    async def check(client):
        async with client.stream("joint_states", rate="full") as stream:
            station.loop.step(3)
            return await stream.wait_for(lambda frame: frame.stamp > 0.0, 5.0)

    assert run_with(served, check).data["samples"]


def test_waiting_ends_in_time_and_the_stream_goes_on(served):
    async def check(client):
        async with client.stream("joint_states") as stream:
            with pytest.raises(StreamTimeoutError, match="within"):
                await stream.wait_for(lambda _: False, 0.05)
            return await stream.receive(5.0)

    assert run_with(served, check).topic == "joint_states"
