"""Ten subscribers of joint states at 100 Hz, and one that never reads.

By hand, on a quiet machine, against `station run --rosbridge` without a dashboard:

    python tools/ros_clients/subscribers.py ws://127.0.0.1:9090 --pid PID

It prints what each subscriber got and missed, the latest frame over its due time, and
the share of a core that the station used without and with them.
"""

import argparse
import asyncio
import json
import os
from pathlib import Path
from time import monotonic

import websockets

SUBSCRIBE = json.dumps({"op": "subscribe", "topic": "/joint_states"})
PERIOD = 0.01
_TICK = os.sysconf("SC_CLK_TCK")


def processor_time(pid: int) -> float:
    """Return the time that a process has used [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICK


async def share(pid: int, seconds: float) -> float:
    """Return the share of a core that a process uses in some seconds."""
    before, begin = processor_time(pid), monotonic()
    await asyncio.sleep(seconds)
    return (processor_time(pid) - before) / (monotonic() - begin)


async def read(url: str, stamps: list[tuple[int, float]]) -> None:
    """Note the stamp [ns] and the arrival [s] of every message."""
    async with websockets.connect(url) as client:
        await client.send(SUBSCRIBE)
        async for message in client:
            stamp = json.loads(message)["msg"]["header"]["stamp"]
            stamps.append((stamp["secs"] * 10**9 + stamp["nsecs"], monotonic()))


async def never_read(url: str, seconds: float) -> None:
    """Subscribe over a connection whose small buffers are never emptied."""
    host, _, port = url.removeprefix("ws://").rstrip("/").partition(":")
    reader, writer = await asyncio.open_connection(host, int(port), limit=1024)
    writer.write(
        f"GET / HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
    )
    await reader.readuntil(b"\r\n\r\n")
    reader._transport.pause_reading()  # noqa: SLF001 - nothing else stops asyncio
    data = SUBSCRIBE.encode()  # masked with zeros
    writer.write(bytes([0x81, 0x80 | len(data), 0, 0, 0, 0]) + data)
    await asyncio.sleep(seconds)


async def measure(url: str, pid: int, number: int, seconds: float) -> None:
    """Print what the subscribers get, and what they cost."""
    alone = await share(pid, seconds)
    heard: list[list[tuple[int, float]]] = [[] for _ in range(number)]
    readers = [asyncio.create_task(read(url, one)) for one in heard]
    readers.append(asyncio.create_task(never_read(url, 10 * seconds)))
    await asyncio.sleep(1.0)
    for one in heard:
        one.clear()
    together = await share(pid, seconds)
    every = sorted(set().union(*({stamp for stamp, _ in one} for one in heard)))
    for index, one in enumerate(heard):
        got = [stamp for stamp, _ in one]
        missed = sum(got[0] < stamp < got[-1] for stamp in every) + 2 - len(got)
        offset = min(at - stamp / 1e9 for stamp, at in one)
        late = max(at - stamp / 1e9 for stamp, at in one) - offset
        print(f"{index}: {len(got) / seconds:.1f} Hz, {missed} missed, "
              f"latest {1e3 * late:.1f} ms")  # fmt: skip
    print(f"share of a core: {alone:.3f} without, {together:.3f} with, "
          f"{together - alone:.3f} for {number} and one that never reads")  # fmt: skip
    for reader in readers:
        reader.cancel()


def main() -> None:
    """Read the arguments and measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("url")
    parser.add_argument("--pid", type=int, required=True)
    parser.add_argument("--number", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=10.0)
    given = parser.parse_args()
    asyncio.run(measure(given.url, given.pid, given.number, given.seconds))


if __name__ == "__main__":
    main()
