"""How the benchmarks measure and print: medians of repeats, and the machine."""

import os
import platform
import statistics
import sys
import timeit
from collections.abc import Callable, Sequence
from pathlib import Path

import mujoco
import numpy as np

from station.core.facade.station import Station
from station.hw.mujoco.shared_world import SharedWorld
from station.hw.mujoco.world import World

REPEATS = 7


def median_time(action: Callable[[], object], number: int) -> float:
    """Return how long one execution takes, the median of several repeats [us].

    Args:
        action: What to measure.
        number: How often a repeat executes it.
    """
    times = timeit.repeat(action, number=number, repeat=REPEATS)
    return statistics.median(times) / number * 1e6


def simulated_world(station: Station) -> World:
    """Return the MuJoCo world of a station's robot.

    Raises:
        TypeError: It has none.
    """
    found = station.loop.hw.simulated_world()
    if not isinstance(found, SharedWorld):
        raise TypeError("the station has no robot that MuJoCo simulates")
    return found.world


def print_title(title: str) -> None:
    """Print what is measured, and on what."""
    load = os.getloadavg()[0]
    sys.stdout.write(
        f"\n{title}\n"
        f"{processor()}, {os.cpu_count()} cores, load {load:.1f}, "
        f"CPython {platform.python_version()}, NumPy {np.__version__}, "
        f"MuJoCo {mujoco.mj_versionString()}\n"
    )


def print_table(headers: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Print rows under their headers; numbers with three significant digits."""
    cells = [list(headers), *([_cell(value) for value in row] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for row in cells:
        first, *others = zip(row, widths, strict=True)
        aligned = [text.rjust(width) for text, width in others]
        sys.stdout.write("  ".join([first[0].ljust(first[1]), *aligned]) + "\n")
    sys.stdout.flush()


def _cell(value: object) -> str:
    if not isinstance(value, float):
        return str(value)
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def processor() -> str:
    """Return the name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    return names[0] if names else platform.machine()
