"""Does the whole station keep its rate: dashboard and five streams of 100 Hz.

Run `python benchmarks/bench_station.py [--seconds 60] [--clients 5]` on a machine that
does nothing else. It starts `station run` with its dashboard in processes of their own,
reads streams as a sixth process, and prints what the station's own /loop says.
"""

import argparse
import asyncio
import sys
import threading

from live import RATE, SETTLING, read_streams, running_station
from measuring import print_table, print_title

from station.client import StationClient
from station.wire import LoopReport, Percentiles

CONTROLLER = "effort_group_position_controller"


def measure(seconds: float, clients: int) -> tuple[LoopReport, list[int]]:
    """Return what /loop says at the end, and the frames each client got."""
    with (
        running_station() as access,
        StationClient(access["url"], access["token"]) as client,
    ):
        client.switch_controllers(start=[CONTROLLER])
        reset = threading.Timer(SETTLING, client.reset_loop_statistics)
        reset.start()
        whole = SETTLING + seconds
        frames = asyncio.run(
            read_streams(access["url"], access["token"], clients, whole)
        )
        reset.join()
        return client.loop(), [round(one * seconds / whole) for one in frames]


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
