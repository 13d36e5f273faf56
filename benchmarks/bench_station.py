"""Does the whole station keep its rate: dashboard and five streams of 100 Hz.

Run `python benchmarks/bench_station.py [--seconds 60] [--clients 5]` on a machine that
does nothing else. It starts `station run` with its dashboard in processes of their own,
reads streams as a sixth process, and prints what the station's own /loop says.
"""

import argparse
import asyncio
import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

from measuring import print_table, print_title

from station.client import AsyncStationClient, StationClient
from station.wire import LoopReport, Percentiles

CONTROLLER = "effort_group_position_controller"
RATE = 100.0
PATIENCE = 120.0
"""How long station and dashboard may take to start [s]."""


@contextlib.contextmanager
def running_station(folder: Path) -> Iterator[dict[str, str]]:
    """Run a station with its dashboard; yield what its runtime file says.

    Raises:
        RuntimeError: It does not start.
    """
    output = folder / "stdout"
    with output.open("w") as stdout:
        process = subprocess.Popen(
            [
                *(sys.executable, "-m", "station", "run", "--json"),
                *("--port", "0", "--ui-port", "0"),
            ],
            env={**os.environ, "XDG_RUNTIME_DIR": str(folder)},
            stdout=stdout,
        )
    try:
        # One line when the API answers, one more when the dashboard does.
        deadline = monotonic() + PATIENCE
        while len(lines := output.read_text().splitlines()) < 2:
            if process.poll() is not None or monotonic() > deadline:
                raise RuntimeError("the station did not start; see its messages")
            sleep(0.1)
        path = Path(json.loads(lines[0])["runtime_file"])
        yield json.loads(path.read_text())
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(10.0)


async def read_streams(url: str, token: str, clients: int, seconds: float) -> list[int]:
    """Read as many streams for a while; return how many frames each one got."""

    async def read(client: AsyncStationClient) -> int:
        frames = 0
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                async for _ in client.stream("joint_states", rate=RATE):
                    frames += 1
        return frames

    async with AsyncStationClient(url, token) as client:
        return await asyncio.gather(*(read(client) for _ in range(clients)))


def measure(seconds: float, clients: int) -> tuple[LoopReport, list[int]]:
    """Return what /loop says at the end, and the frames each client got."""
    with (
        tempfile.TemporaryDirectory() as folder,
        running_station(Path(folder)) as access,
        StationClient(access["url"], access["token"]) as client,
    ):
        client.switch_controllers(start=[CONTROLLER])
        client.reset_loop_statistics()
        frames = asyncio.run(
            read_streams(access["url"], access["token"], clients, seconds)
        )
        return client.loop(), frames


def _microseconds(name: str, values: Percentiles) -> list[object]:
    return [name, *(v * 1e6 for v in (values.p50, values.p99, values.p999, values.max))]


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--clients", type=int, default=5)
    options = parser.parse_args()
    loop, frames = measure(options.seconds, options.clients)
    print_title(
        f"The station for {options.seconds:g} s: dashboard, {options.clients} clients "
        f"at {RATE:g} Hz [us]"
    )
    print_table(
        ("what", "p50", "p99", "p99.9", "max"),
        [
            _microseconds(name, getattr(loop, name))
            for name in ("lateness", "read", "update", "write", "total")
        ],
    )
    sys.stdout.write(
        f"{loop.achieved_rate:.2f} Hz of {loop.rate:g}, {loop.cycles} cycles, "
        f"{loop.skipped} deadlines skipped, {loop.scheduler}\n"
        f"frames per client and second: "
        f"{', '.join(f'{count / options.seconds:.1f}' for count in frames)}\n"
    )


if __name__ == "__main__":
    main()
