"""What many stream clients cost the station, and whether every frame arrives.

Run `python benchmarks/bench_streams.py [--clients 50] [--rate 100] [--seconds 10]`. It
starts `station run` without dashboard in a process of its own, measures the processor
time of that process with no client and with all of them, and counts the frames.
"""

import argparse
import asyncio
import contextlib
import os
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic

from bench_station import CONTROLLER
from live import running_station
from measuring import print_table, print_title
from typing_extensions import override

from station.client import StationClient

_SEQ = re.compile(rb'"seq":(\d+)')
_TICK = os.sysconf("SC_CLK_TCK")


@dataclass
class Count:
    """What one client received.

    Attributes:
        frames: How many frames.
        missed: How many numbers were left out between them.
        last: The last number.
    """

    frames: int = 0
    missed: int = 0
    last: int | None = field(default=None)


class StreamReader(asyncio.Protocol):
    """Counts the frames of a stream; far cheaper than a WebSocket library.

    Args:
        request: The request that opens the WebSocket.
    """

    def __init__(self, request: bytes) -> None:
        self.count = Count()
        self.opened_at: float | None = None
        self._request = request
        self._buffer = bytearray()

    @override
    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if isinstance(transport, asyncio.WriteTransport):
            transport.write(self._request)

    @override
    def data_received(self, data: bytes) -> None:
        self._buffer += data
        if self.opened_at is None:
            end = self._buffer.find(b"\r\n\r\n")
            if end < 0:
                return
            self.opened_at = monotonic()
            del self._buffer[: end + 4]
        while self._take_frame():
            pass

    def _take_frame(self) -> bool:
        buffer = self._buffer
        if len(buffer) < 4:
            return False
        length, begin = buffer[1], 2
        if length == 126:
            length, begin = int.from_bytes(buffer[2:4]), 4
        elif length == 127:
            if len(buffer) < 10:
                return False
            length, begin = int.from_bytes(buffer[2:10]), 10
        if len(buffer) < begin + length:
            return False
        found = _SEQ.search(buffer, begin, begin + min(length, 200))
        if found is not None and buffer[0] & 0x0F == 1:
            self._note(int(found[1]))
        del buffer[: begin + length]
        return True

    def _note(self, number: int) -> None:
        count = self.count
        if count.last is not None:  # the first frame is `hello`
            count.frames += 1
            count.missed += max(0, number - count.last - 1)
        count.last = number


def handshake(url: str, token: str, path: str) -> bytes:
    """Return the request that opens a WebSocket."""
    host = url.partition("//")[2]
    lines = (
        f"GET /api/v1/streams/{path} HTTP/1.1",
        f"Host: {host}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version: 13",
        f"Authorization: Bearer {token}",
        "\r\n",
    )
    return "\r\n".join(lines).encode()


def processor_time(pid: int) -> float:
    """Return the processor time that a process has used [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICK


async def share_of_a_core(pid: int, seconds: float) -> float:
    """Return which part of a core a process uses for a while."""
    before, began = processor_time(pid), monotonic()
    await asyncio.sleep(seconds)
    return (processor_time(pid) - before) / (monotonic() - began)


async def open_streams(
    url: str, request: bytes, clients: int
) -> list[tuple[asyncio.Transport, StreamReader]]:
    """Open as many streams at once.

    Raises:
        TimeoutError: The station does not open them.
    """
    host, _, port = url.partition("//")[2].partition(":")
    loop = asyncio.get_running_loop()
    opened = await asyncio.gather(
        *(
            loop.create_connection(lambda: StreamReader(request), host, int(port))
            for _ in range(clients)
        )
    )
    deadline = monotonic() + 20.0
    while any(reader.opened_at is None for _, reader in opened):
        if monotonic() > deadline:
            raise TimeoutError("not every stream was opened within 20 s")
        await asyncio.sleep(0.01)
    return opened


async def measure(
    url: str, token: str, pid: int, options: argparse.Namespace
) -> dict[str, object]:
    """Return the shares of a core, and what the clients received."""
    request = handshake(
        url, token, f"joint_states?rate={options.rate:g}&format={options.format}"
    )
    alone = await share_of_a_core(pid, options.seconds)
    began = monotonic()
    streams = await open_streams(url, request, options.clients)
    opening = max(reader.opened_at or 0.0 for _, reader in streams) - began
    await asyncio.sleep(1.0)
    with StationClient(url, token) as client:
        client.reset_loop_statistics()
        for _, reader in streams:
            reader.count = Count()
        shared = await share_of_a_core(pid, options.seconds)
        lateness = client.loop().lateness.p99
    counts = [reader.count for _, reader in streams]
    for transport, _ in streams:
        transport.close()
    return {
        "cores without clients": alone,
        "cores with clients": shared,
        "cores for the clients": shared - alone,
        "time to open them all [s]": opening,
        "frames per client and second": sum(c.frames for c in counts)
        / len(counts)
        / options.seconds,
        "frames missed": sum(c.missed for c in counts),
        "lateness p99 [us]": lateness * 1e6,
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clients", type=int, default=50)
    parser.add_argument("--rate", type=float, default=100.0)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--format", choices=("json", "msgpack"), default="json")
    options = parser.parse_args()
    with running_station(has_dashboard=False) as access:
        with StationClient(access["url"], access["token"]) as client:
            client.switch_controllers(start=[CONTROLLER])
        found = asyncio.run(
            measure(access["url"], access["token"], int(access["pid"]), options)
        )
    print_title(f"{options.clients} clients at {options.rate:g} Hz, {options.format}")
    print_table(("what", "value"), [list(row) for row in found.items()])


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        sys.exit(main())
