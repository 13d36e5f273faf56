"""Streams for asyncio: addresses, frames, reconnection, refusals, set-points."""

import asyncio
import json
import math

import pytest
from websockets.asyncio.client import connect
from websockets.asyncio.server import serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.frames import Close
from websockets.http11 import Response

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.client import (
    ApiError,
    AsyncStationClient,
    StationUnreachableError,
    StreamTimeoutError,
    streams,
)
from station.client.streams import (
    FIRST_DELAY,
    LONGEST_DELAY,
    AsyncStream,
    Backoff,
    CommandOptions,
    StreamOptions,
    StreamProgress,
    bearer,
    close_connection,
    refusal,
    written,
)
from tests.api.conftest import OPERATOR
from tests.api.spring import make_station
from tests.franka_station import make_franka_station
from tests.waiting import PATIENCE


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
    monkeypatch.setattr(streams, "FIRST_DELAY", 0.01)
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


def test_an_interrupted_entry_leaves_no_link_open():
    async def work():
        entered, gone = asyncio.Event(), asyncio.Event()

        async def say_nothing(link):
            await (await link.ping())  # answered: the client waits for the hello
            entered.set()
            await link.wait_closed()
            gone.set()

        async with serve(say_nothing, "127.0.0.1", 0) as server:
            port = server.sockets[0].getsockname()[1]
            options = StreamOptions(f"http://127.0.0.1:{port}", None, "loop")
            entering = asyncio.create_task(AsyncStream(options).__aenter__())
            await entered.wait()
            entering.cancel()
            await asyncio.wait([entering])
            await asyncio.wait_for(gone.wait(), PATIENCE)

    asyncio.run(work())


def test_an_end_that_is_cut_short_leaves_no_socket_open():
    async def work():
        deaf = asyncio.Event()

        async def never_answer(link):
            link.transport.pause_reading()
            deaf.set()
            await link.wait_closed()

        async with serve(never_answer, "127.0.0.1", 0, close_timeout=0.01) as server:
            port = server.sockets[0].getsockname()[1]
            connection = await connect(f"ws://127.0.0.1:{port}", proxy=None)
            await deaf.wait()
            closing = asyncio.create_task(close_connection(connection))
            await asyncio.sleep(0)  # it waits for the answer now
            closing.cancel()
            await asyncio.wait([closing])
            assert connection.transport.is_closing()

    asyncio.run(work())


def test_frame_that_fulfils_a_condition_is_waited_for(served, station):
    async def check(client):
        async with client.stream("joint_states", rate="full") as stream:
            station.loop.step(3)
            return await stream.wait_for(lambda frame: frame.stamp > 0.0, PATIENCE)

    assert run_with(served, check).data["samples"]


def test_waiting_ends_in_time_and_the_stream_goes_on(served):
    async def check(client):
        async with client.stream("joint_states") as stream:
            with pytest.raises(StreamTimeoutError, match="within"):
                await stream.wait_for(lambda _: False, 0.05)
            return await stream.receive(5.0)

    assert run_with(served, check).topic == "joint_states"


@pytest.mark.parametrize(
    ("options", "url"),
    [
        (("http://h:1", None, "loop"), "ws://h:1/api/v1/streams/loop"),
        (("https://h", None, "loop", 5), "wss://h/api/v1/streams/loop?rate=5"),
        (
            ("http://h", None, "controller_state/a b", "full", ("x", "y")),
            "ws://h/api/v1/streams/controller_state/a%20b?rate=full&fields=x%2Cy",
        ),
    ],
)
def test_the_url_of_a_stream(options, url):
    assert StreamOptions(*options).url() == url


def test_a_token_is_never_in_the_url():
    options = StreamOptions("http://h", "secret", "loop")

    assert "secret" not in options.url()
    assert bearer("secret") == {"Authorization": "Bearer secret"}
    assert bearer(None) == {}


def test_the_back_off_doubles_up_to_its_limit_and_starts_over():
    backoff = Backoff()
    delays = [backoff.next() for _ in range(12)]

    assert 0.5 * FIRST_DELAY <= delays[0] <= FIRST_DELAY
    assert 0.5 * LONGEST_DELAY <= delays[-1] <= LONGEST_DELAY
    backoff.reset()
    assert backoff.next() <= FIRST_DELAY


def test_hello_is_kept_and_its_boot_id_is_in_every_frame():
    progress = StreamProgress()
    assert progress.snapshot() == {}

    hello = '"topic":"hello","seq":0,"epoch":1,"stamp":0.1,"boot_id":"b","data":{"a":1}'
    assert progress.accept(f"{{{hello}}}") is None
    assert progress.connected
    assert progress.snapshot() == {"a": 1}

    frame = progress.accept('{"topic":"loop","seq":1,"epoch":1,"stamp":0.2,"data":{}}')
    assert (frame.topic, frame.boot_id) == ("loop", "b")


@pytest.mark.parametrize(
    ("final", "code"),
    [
        *((True, code) for code in (4400, 4401, 4403, 4404)),
        *((False, code) for code in (1001, 1006, 1011, 1013, 4408)),
    ],
)
def test_only_refusals_are_final(code, final):
    error = ConnectionClosedError(Close(code, "why") if code != 1006 else None, None)

    refused = refusal(error)

    assert (refused is not None) is final
    if refused is not None:
        assert refused.status == code
        assert str(refused).startswith("why")
        assert refused.remedy


@pytest.mark.parametrize(("status", "final"), [(404, True), (403, True), (503, False)])
def test_a_refused_handshake_is_final_unless_the_server_is_to_blame(status, final):
    error = InvalidStatus(Response(status, "x", Headers(), b"no station"))

    assert (refusal(error) is not None) is final


def test_a_broken_line_is_not_final():
    assert refusal(ConnectionRefusedError()) is None


def test_the_address_names_the_controller_and_the_timeout():
    options = CommandOptions("https://lab:8000", "t", "key", "a/b", 0.5)

    path = "/api/v1/streams/command/a%2Fb?timeout=0.5"
    assert options.url() == f"wss://lab:8000{path}"
    assert options.headers() == {
        "Authorization": "Bearer t",
        "X-Control-Lease": "key",
    }


def test_a_message_has_what_is_known_alone():
    assert json.loads(written([0.5], None, None)) == {"command": [0.5]}
    assert json.loads(written((1,), 3, [2.0])) == {
        "command": [1],
        "epoch": 3,
        "rates": [2.0],
    }


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_what_is_not_finite_is_not_sent(number):
    with pytest.raises(ValueError, match="finite"):
        written([number], None, None)
