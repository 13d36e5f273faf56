"""Two actions measured in turns, hot and cold, by low quantiles.

Other programs only ever make a measurement longer, so a low quantile is what repeats
from run to run; a median tells how busy the machine was.
"""

import os
import statistics
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from time import perf_counter, sleep

QUANTILE = 0.1
"""Which quantile of the blocks counts."""
PRIORITY = 50
"""Priority under SCHED_FIFO."""
PAUSE = 0.0008
"""Sleep before a cold measurement [s]: what a loop of 1 kHz sleeps."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How much is measured.

    Attributes:
        blocks: Blocks of each side, hot.
        calls: Calls in a block.
        pairs: Single calls of each side, cold.
    """

    blocks: int = 25
    calls: int = 400
    pairs: int = 400


@dataclass(frozen=True, slots=True)
class Turns:
    """What two actions cost that took turns.

    Attributes:
        step_us: The bare simulation step [us].
        cycle_us: The whole cycle [us].
    """

    step_us: float
    cycle_us: float

    def row(self) -> dict[str, float]:
        """Return the figures of a row of the table."""
        return {
            "mj_step_us": round(self.step_us, 2),
            "cycle_us": round(self.cycle_us, 2),
            "ratio": round(self.cycle_us / self.step_us, 3),
            "above_step_us": round(self.cycle_us - self.step_us, 2),
        }


def measure_hot(
    step: Callable[[int], object],
    cycle: Callable[[int], object],
    begin: Callable[[], object],
    effort: Effort,
) -> Turns:
    """Return what a step and a cycle cost in blocks that follow one another.

    Args:
        step: Makes as many bare steps.
        cycle: Runs as many cycles.
        begin: Called before each block of steps: the steps begin where the cycles are.
        effort: How much is measured.
    """
    steps, cycles = [], []
    for _ in range(effort.blocks):
        begin()
        steps.append(_time(step, effort.calls))
        cycles.append(_time(cycle, effort.calls))
    return Turns(low(steps), low(cycles))


def measure_cold(
    step: Callable[[int], object],
    cycle: Callable[[int], object],
    begin: Callable[[], object],
    effort: Effort,
) -> Turns:
    """Return what one step and one cycle cost after a sleep; as `measure_hot`."""
    steps, cycles = [], []
    begin()
    for _ in range(effort.pairs):
        sleep(PAUSE)
        steps.append(_time(step, 1))
        sleep(PAUSE)
        cycles.append(_time(cycle, 1))
    return Turns(low(steps), low(cycles))


def ask_for_processor() -> None:
    """Run under SCHED_FIFO from now on, where the system permits it."""
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))


def low(times: list[float]) -> float:
    """Return the low quantile that counts."""
    if len(times) < 2:
        return times[0]
    return statistics.quantiles(times, n=round(1 / QUANTILE), method="inclusive")[0]


def _time(action: Callable[[int], object], calls: int) -> float:
    begin = perf_counter()
    action(calls)
    return (perf_counter() - begin) / calls * 1e6
