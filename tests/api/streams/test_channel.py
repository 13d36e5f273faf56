"""Frames are made once, and a late client gets the newest."""

import asyncio
import json
import math

import msgspec
import pytest
from websockets.frames import Opcode
from websockets.protocol import CLIENT, OPEN, Protocol

from station.api.streams.channel import (
    Frame,
    FullChannel,
    StateChannel,
    StreamClient,
    encode,
    open_channel,
)
from station.api.streams.cycle_samples import BATCH_LIMIT, Payload
from station.api.streams.request import parse_request
from tests.api.spring import make_station


@pytest.fixture
def station():
    station = make_station()
    station.loop.step()
    return station


def channel_of(station, topic="joint_states", **query):
    request = parse_request(station, topic, query)
    return open_channel(*request, station.loop.cycle_yield)


def test_the_kind_of_channel_follows_the_rate(station):
    assert isinstance(channel_of(station, rate="50"), StateChannel)
    assert isinstance(channel_of(station, rate="full"), FullChannel)


def test_clients_of_a_channel_share_the_frame(station):
    async def run():
        channel = channel_of(station)
        await channel.tick()
        return channel.take(0), channel.take(0)

    one, other = asyncio.run(run())
    assert one is other
    assert json.loads(one.message)["seq"] == 1


def test_a_late_client_gets_the_newest_and_sees_the_gap(station):
    async def run():
        channel = channel_of(station)
        for _ in range(5):
            await channel.tick()
            station.loop.step()
        return channel.take(1)

    frame = asyncio.run(run())
    assert frame.seq == 5
    assert json.loads(frame.message)["data"]["stamp"] == 0.005


def test_an_unchanged_state_is_not_repeated_at_once(station):
    async def run():
        channel = channel_of(station)
        await channel.tick()
        await channel.tick()
        return channel.take(0)

    assert asyncio.run(run()).seq == 1


def test_a_new_client_gets_the_newest_frame_at_once(station):
    async def run():
        channel = channel_of(station)
        assert channel.beginning == 0
        for _ in range(3):
            await channel.tick()
            station.loop.step()
        return channel.take(channel.beginning)

    assert asyncio.run(run()).seq == 3


def test_a_new_client_of_every_cycle_begins_with_the_next(station):
    station.loop.step(9)
    channel = channel_of(station, rate="full")

    assert channel.beginning == 10


class Client:
    """Takes every frame, and counts the ticks until a number of them."""

    def __init__(self, channel, ticks=1):
        self.frames = []
        self.error = None
        self.done = asyncio.Event()
        self._channel = channel
        self._ticks = ticks

    def ticked(self):
        after = self.frames[-1].seq if self.frames else 0
        self.frames.append(self._channel.take(after))
        if len(self.frames) == self._ticks:
            self.done.set()

    def failed(self, error):
        self.error = error
        self.done.set()


def test_a_channel_ticks_while_it_has_clients(station):
    async def run():
        channel = channel_of(station, rate="500")
        one, other = Client(channel), Client(channel)
        channel.join(one)
        channel.join(other)
        await one.done.wait()
        channel.leave(one)
        assert channel.clients == 1
        channel.leave(other)
        await asyncio.sleep(0)
        return one.frames, other.frames, len(asyncio.all_tasks())

    ones, others, tasks = asyncio.run(run())
    assert ones[0].seq == 1
    assert ones[0] is others[0]
    assert tasks == 1


@pytest.mark.parametrize("is_late", [False, True])
def test_clients_learn_that_a_channel_broke_down(station, monkeypatch, is_late):
    async def run():
        channel = channel_of(station)

        async def fail():
            raise ZeroDivisionError

        monkeypatch.setattr(channel, "tick", fail)
        client = Client(channel)
        channel.join(client)
        await client.done.wait()
        if is_late:
            client = Client(channel)
            channel.join(client)
        return client.error

    assert isinstance(asyncio.run(run()), ZeroDivisionError)


def test_full_loses_no_cycle_whatever_the_pace_of_the_client(station):
    async def run(paces):
        channel = channel_of(station, rate="full")
        seq, cycles = channel.beginning, []
        for pace in paces:
            station.loop.step(pace)
            await channel.tick()
            while seq < channel.beginning:
                frame = channel.take(seq)
                data = json.loads(frame.message)["data"]
                assert len(data["samples"]) <= BATCH_LIMIT
                assert data["lost"] == 0
                cycles += [sample["cycle"] for sample in data["samples"]]
                seq = frame.seq
        return cycles

    paces = [1, 20, 3, 2 * BATCH_LIMIT + 7, 20]
    assert asyncio.run(run(paces)) == list(range(2, 2 + sum(paces)))


def test_full_batches_are_shared_by_clients_that_keep_up(station):
    async def run():
        channel = channel_of(station, rate="full")
        station.loop.step(5)
        await channel.tick()
        return channel.take(1), channel.take(1), channel.take(3)

    one, other, behind = asyncio.run(run())
    assert one is other
    assert one.seq == behind.seq == 6
    assert len(json.loads(behind.message)["data"]["samples"]) == 3


def test_a_channel_looks_for_the_control_loop_before_each_client(station, monkeypatch):
    looks = []
    monkeypatch.setattr(
        station.loop.cycle_yield, "wait_if_cycle_is_due", lambda: looks.append("look")
    )

    class Client:
        def __init__(self) -> None:
            self.ticks = asyncio.Event()

        def ticked(self) -> None:
            looks.append(self)
            self.ticks.set()

        def failed(self, error: BaseException) -> None:
            raise AssertionError(error)

    async def run():
        channel = channel_of(station)
        one, other = Client(), Client()
        channel.join(one)
        channel.join(other)
        await other.ticks.wait()
        channel.leave(one)
        channel.leave(other)
        return one, other

    one, other = asyncio.run(run())
    assert looks[:5] == ["look", "look", one, "look", other]


PAYLOAD = Payload(7, 2, 0.5, {"name": ["j"], "position": [0.25], "effort": [math.nan]})
BATCH = Payload(
    9,
    2,
    0.5,
    {
        "name": ["j"],
        "samples": [{"cycle": 8, "stamp": 0.1, "position": [1.0]}],
        "lost": 3,
    },
)


def test_json_has_the_six_keys_and_null_for_what_is_not_finite():
    frame = encode("t", PAYLOAD, seq=3, format="json")

    assert frame.seq == 3
    assert json.loads(frame.message) == {
        "topic": "t",
        "seq": 3,
        "epoch": 2,
        "cycle": 7,
        "stamp": 0.5,
        "data": {"name": ["j"], "position": [0.25], "effort": [None]},
    }


def test_msgpack_says_the_same():
    frame = encode("t", BATCH, seq=3, format="msgpack", boot_id="b")

    message = msgspec.msgpack.decode(frame.message)
    assert message["data"] == BATCH.data
    assert message["boot_id"] == "b"


@pytest.mark.parametrize(
    ("payload", "fields", "data"),
    [
        (PAYLOAD, {"position"}, {"position": [0.25]}),
        (PAYLOAD, {"name", "position"}, {"name": ["j"], "position": [0.25]}),
        (
            BATCH,
            {"position"},
            {"samples": [{"cycle": 8, "position": [1.0]}], "lost": 3},
        ),
        (
            BATCH,
            {"name", "stamp"},
            {"name": ["j"], "samples": [{"cycle": 8, "stamp": 0.1}], "lost": 3},
        ),
    ],
)
def test_fields_choose_keys(payload, fields, data):
    frame = encode("t", payload, seq=1, format="json", fields=frozenset(fields))

    assert json.loads(frame.message)["data"] == data


@pytest.mark.parametrize("form", ["json", "msgpack"])
@pytest.mark.parametrize("size", [1, 200, 70_000])
def test_a_websocket_client_reads_the_message_from_the_wire(form, size):
    frame = encode("t", Payload(1, 1, 0.0, {"x": "y" * size}), seq=1, format=form)

    protocol = Protocol(CLIENT, state=OPEN)
    protocol.receive_data(frame.wire)

    (received,) = protocol.events_received()
    assert received.opcode is (Opcode.TEXT if form == "json" else Opcode.BINARY)
    assert received.data == frame.message


class Port:
    """A connection that the test blocks and unblocks."""

    def __init__(self):
        self.wires = []
        self.writable = True
        self.resumed = None

    def write_frame(self, wire):
        self.wires.append(wire)

    def is_writable(self):
        return self.writable

    def listen(self, resumed):
        self.resumed = resumed


class Numbers:
    """A channel whose frames are the numbers up to the newest, each told once."""

    request = type("Request", (), {"topic": "numbers"})

    def __init__(self):
        self.newest = 0

    def take(self, after):
        if after >= self.newest:
            return None
        return Frame(after + 1, b"", b"%d" % (after + 1))


HELLO = Frame(0, b"", b"hello")


def run(drive, slow_after=60.0):
    """Let `drive(port, channel, client)` happen while the client is served."""

    async def both():
        port, channel = Port(), Numbers()
        client = StreamClient(port, channel, slow_after)
        serving = asyncio.create_task(client.serve(HELLO))
        await asyncio.sleep(0)
        await drive(port, channel, client)
        if slow_after < 1.0:
            await serving
        else:
            serving.cancel()
            await asyncio.gather(serving, return_exceptions=True)
        return port

    return asyncio.run(both())


def test_hello_is_first_and_ticks_before_it_are_left_out():
    async def drive():
        port, channel = Port(), Numbers()
        channel.newest = 3
        client = StreamClient(port, channel, 1.0)
        client.ticked()
        assert port.wires == []
        serving = asyncio.create_task(client.serve(Frame(2, b"", b"hello")))
        await asyncio.sleep(0)
        serving.cancel()
        return port.wires

    assert asyncio.run(drive()) == [b"hello", b"3"]


def test_missed_batches_follow_without_another_tick():
    async def drive(port, channel, client):
        channel.newest = 3
        client.ticked()
        assert port.wires == [b"hello", b"1"]
        for _ in range(5):
            await asyncio.sleep(0)

    assert run(drive).wires == [b"hello", b"1", b"2", b"3"]


def test_a_connection_that_takes_nothing_gets_nothing_until_it_takes_more():
    async def drive(port, channel, client):
        port.writable = False
        channel.newest = 1
        client.ticked()
        channel.newest = 2
        client.ticked()
        assert port.wires == [b"hello", b"1"]
        port.writable = True
        port.resumed()

    port = run(drive)
    assert port.wires == [b"hello", b"1", b"2"]
    assert port.resumed is None


def test_serving_ends_when_the_connection_takes_nothing_for_too_long():
    async def drive(port, channel, client):
        port.writable = False
        channel.newest = 1
        client.ticked()

    assert run(drive, slow_after=0.001).wires == [b"hello", b"1"]


def test_serving_raises_when_the_channel_breaks_down():
    async def drive():
        client = StreamClient(Port(), Numbers(), 1.0)
        serving = asyncio.create_task(client.serve(HELLO))
        await asyncio.sleep(0)
        client.failed(ZeroDivisionError())
        await serving

    with pytest.raises(RuntimeError, match="numbers broke down") as caught:
        asyncio.run(drive())
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
