"""Whether a recording has every cycle, what it costs, and what a kill takes from it.

Run `python benchmarks/bench_recording.py [--seconds 60]`. It starts `station run`
without dashboard in processes of its own: one records for the given time, with the
processor time of the station while it records and while it does not; another is killed
while it records, and its file is mended.
"""

import argparse
import os
import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import yaml
from live import running_station
from measuring import print_table, print_title

from station.client import StationClient
from station.records.mcap_recovery import recover_file
from station.records.recording_reader import read_trajectory

BEFORE_KILL = 3.0
"""How long is recorded before the station is killed [s]."""
_TICK = os.sysconf("SC_CLK_TCK")


@contextmanager
def recording_station(folder: Path) -> Iterator[tuple[StationClient, int]]:
    """Run a station that records into a folder; yield a client and its process id."""
    config = folder / "station.yaml"
    config.write_text(yaml.safe_dump({"records": {"directory": str(folder / "kept")}}))
    with (
        running_station(str(config), has_dashboard=False) as access,
        StationClient(access["url"], access["token"]) as client,
    ):
        yield client, int(access["pid"])


def processor_share(pid: int, seconds: float) -> float:
    """Wait, and return how much of one processor a process used meanwhile."""
    before, begin = _processor_time(pid), monotonic()
    sleep(seconds)
    return (_processor_time(pid) - before) / (monotonic() - begin)


def measure_whole(seconds: float) -> list[object]:
    """Record for some time; return the row of the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with recording_station(folder) as (client, pid):
            idle = processor_share(pid, min(seconds, 10.0))
            started = client.recordings.start("bench")
            busy = processor_share(pid, seconds)
            stopped = client.recordings.stop()
            path = client.recordings.download(started.identifier, folder / "whole.mcap")
        cycles = read_trajectory(path).cycle
    steps = np.diff(cycles)
    missing, repeated = int((steps - 1).clip(0).sum()), int((steps < 1).sum())
    size = stopped.size / len(cycles)
    return [len(cycles), missing, repeated, stopped.lost, size, idle, busy]


def measure_killed() -> list[object]:
    """Kill a station that records; return the row of the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with recording_station(folder) as (client, pid):
            identifier = client.recordings.start("killed").identifier
            sleep(BEFORE_KILL)
            last = client.status().cycle
            os.kill(pid, signal.SIGKILL)
        path = folder / "kept" / f"{identifier}.mcap"
        recover_file(path)
        cycles = read_trajectory(path).cycle
    steps = np.diff(cycles)
    return [len(cycles), int((steps != 1).sum()), max(0, last - int(cycles[-1]))]


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="of the recording")
    seconds = parser.parse_args().seconds
    print_title(f"A recording of {seconds:g} s of a live station")
    print_table(
        [
            "cycles",
            "missing",
            "twice",
            "told as lost",
            "bytes per cycle",
            "processor before",
            "processor while recording",
        ],
        [measure_whole(seconds)],
    )
    print_title(f"Killed with SIGKILL after {BEFORE_KILL:g} s, and mended")
    print_table(["cycles", "gaps", "cycles lost at the end"], [measure_killed()])


def _processor_time(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICK


if __name__ == "__main__":
    main()
