"""One client gets the frames as fast as its connection takes them."""

import asyncio

import pytest

from station.api.streams.channel import Frame, StreamClient


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
