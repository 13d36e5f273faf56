"""A storm: threads load, switch, disturb and stop controllers of a running loop."""

import random
import sys
import threading
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from typing_extensions import override

from station.core.clock import SystemClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import Strictness, SwitchRequest
from station.core.errors import StationError
from station.core.facade.station import Station
from station.core.hardware.robot_hw import RobotHW
from station.core.loop.control_loop import ControlLoop
from station.core.loop.stop_latch import StopState
from station.core.parameters import Parameters
from station.reports import LoopState
from station.testing.scripted import HookScript
from station.testing.storm.storm_worker import (
    STORM_TYPE,
    Disturbances,
    StormController,
    StormWorker,
    find_claims,
)
from station.testing.switch_observer import ChainCheck, SwitchObserver


@dataclass(frozen=True)
class StormReport:
    """The actions and the findings of a storm.

    Attributes:
        seed: Seed of the random operations; it does not fix the order of the threads.
        threads: How many threads there were.
        operations: Number of times each operation was carried out, by name.
        refusals: Number of refused operations, by the code of the error.
        switches: Number of switches that were not refused, by outcome.
        mischiefs: Number of deliberate faults of controllers.
        cycles: Number of cycles that the observer has checked.
        duration: How long the storm took [s wall time].
        problems: Violated contracts, one sentence each; empty if all were kept.
    """

    seed: int
    threads: int
    operations: Counter[str]
    refusals: Counter[str]
    switches: Counter[str]
    mischiefs: int
    cycles: int
    duration: float
    problems: tuple[str, ...]

    @property
    def ok(self) -> bool:
        """Return whether all contracts were kept."""
        return not self.problems

    @override
    def __str__(self) -> str:
        """Return the report as a few lines of text."""
        lines = [
            f"storm of {self.operations.total()} operations by {self.threads} threads, "
            f"seed {self.seed}: {self.duration:.1f} s, {self.cycles} cycles, "
            f"{self.mischiefs} mischiefs",
            f"operations: {_listed(self.operations)}",
            f"refusals: {_listed(self.refusals)}",
            f"switches: {_listed(self.switches)}",
            *(f"PROBLEM {problem}" for problem in self.problems),
            "nothing was wrong" if self.ok else f"{len(self.problems)} problems",
        ]
        return "\n".join(lines)


def _listed(counts: Counter[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counts.most_common())


Fault = Callable[[random.Random], None]
"""Function that makes a robot fail, or ends the failure; called between two cycles."""

_POLL = 0.05
"""Time between two checks of the main thread whether an operation hangs [s]."""


def storm(
    hw_factory: Callable[[], RobotHW],
    *,
    operations: int = 10_000,
    threads: int = 4,
    seed: int = 0,
    faults: Callable[[RobotHW], Sequence[Fault]] | None = None,
    deadline: float = 20.0,
    drift: float = 0.01,
    period: float = 0.001,
) -> StormReport:
    """Run a storm on a robot and return the findings.

    The loop runs in its thread, as in a station. The other threads load, unload and
    switch controllers. Some of these command references of others, raise errors,
    command values that are not numbers, or command resources of other controllers. The
    threads also stop all controllers, release the stop, reload, recover the robot, and
    make its switching hooks refuse and fail. An observer checks every cycle before
    `write`, and each answer of the station is compared with its findings.

    Args:
        hw_factory: Returns the robot, initialised.
        operations: How many operations all threads carry out together.
        threads: How many threads there are.
        seed: Seed of the random operations.
        faults: Function that returns faults of the robot besides those of its hooks.
        deadline: How long an operation may take [s wall time].
        drift: How far a joint without an owner may move [rad or m].
        period: Period of the loop [s].

    Raises:
        ValueError: The robot has no command that a controller could claim.
    """
    robot = hw_factory()
    claims = find_claims(robot)
    if not claims:
        raise ValueError("The robot accepts no claim of any of its commands.")
    hooks = HookScript()
    hooks.install(robot)
    clock, parameters = SystemClock(), Parameters()
    manager = ControllerManager(
        robot, parameters, [TableLoader({STORM_TYPE: StormController})], clock
    )
    observer = SwitchObserver(robot, manager, drift=drift)
    loop = ControlLoop(robot, manager, clock=clock, period=period)
    station = Station(loop, manager, parameters)
    observer.checks += [_Stopped(station), _Owners(manager), ChainCheck(manager)]
    disturbances = Disturbances()
    workers = [
        StormWorker(
            number,
            seed * 1000 + number,
            station,
            observer,
            claims=claims,
            hooks=hooks,
            faults=[] if faults is None else faults(robot),
            disturbances=disturbances,
        )
        for number in range(threads)
    ]
    first, began = manager.cycle, time.monotonic()
    loop.start()
    problems = _run(workers, operations // threads, deadline, loop)
    duration = time.monotonic() - began
    if not problems:
        hooks.begin()
        problems += _calm_down(station, observer)
    if loop.state is LoopState.FAILED:
        problems.append(f"the loop died: {loop.failure_summary()}")
    loop.stop(timeout=deadline)
    return StormReport(
        seed=seed,
        threads=threads,
        operations=_sum(worker.operations for worker in workers),
        refusals=_sum(worker.refusals for worker in workers),
        switches=_sum(worker.switches for worker in workers),
        mischiefs=sum(worker.mischiefs for worker in workers),
        cycles=observer.cycle - first,
        duration=duration,
        problems=(
            *problems,
            *observer.problems,
            *(problem for worker in workers for problem in worker.problems),
        ),
    )


class _Stopped:
    """The check that no controller runs while the stop is latched."""

    def __init__(self, station: Station) -> None:
        self._station = station

    def __call__(self) -> str | None:
        latch = self._station.loop.stop_latch
        # Read the state first and then `pending`, because `engage` sets `pending`
        # first.
        if latch.state is StopState.ARMED or latch.pending:
            return None
        running = [info.name for info in self._station.manager.running()]
        return f"{running} run, and the stop is latched" if running else None


class _Owners:
    """The check that the robot receives exactly the commands of an owner."""

    def __init__(self, manager: ControllerManager) -> None:
        self._manager = manager

    def __call__(self) -> str | None:
        for info in self._manager.running():
            try:
                controller = self._manager.get_controller(info.name)
            except StationError:  # it has just been unloaded
                continue
            if isinstance(controller, StormController) and controller.is_running():
                problem = controller.find_overwritten()
                if problem is not None:
                    return f"{info.name}: {problem}"
        return None


def _run(
    workers: Sequence[StormWorker], operations: int, deadline: float, loop: ControlLoop
) -> list[str]:
    """Run the workers; return a description of each call that hangs."""
    threads = [
        threading.Thread(
            target=worker.run, args=(operations,), name=f"storm {number}", daemon=True
        )
        for number, worker in enumerate(workers)
    ]
    for thread in threads:
        thread.start()
    problems: list[str] = []
    while any(thread.is_alive() for thread in threads) and not problems:
        time.sleep(_POLL)
        now = time.monotonic()
        for thread, worker in zip(threads, workers, strict=True):
            busy = worker.busy
            if busy is not None and now - busy[1] > deadline:
                problems.append(
                    f"'{busy[0]}' takes longer than {deadline} s:\n{_stack(thread)}"
                )
        if loop.state is LoopState.FAILED:
            break
    for worker in workers:
        worker.is_told_to_end = True
    for thread in threads:
        thread.join(deadline)
    return problems


def _stack(thread: threading.Thread) -> str:
    frame = sys._current_frames().get(thread.ident or 0)  # noqa: SLF001 - the only way
    return "" if frame is None else "".join(traceback.format_stack(frame))


def _calm_down(station: Station, observer: SwitchObserver) -> list[str]:
    """Stop and unload all controllers; return the problems that this shows."""
    problems: list[str] = []
    try:
        names = [status.name for status in station.controllers()]
        stopped = station.switch_controllers(
            SwitchRequest(stop=names, strictness=Strictness.BEST_EFFORT)
        )
        if not stopped.ok:
            problems.append(f"after the storm: not stopped: {stopped.failed}")
        for name in names:
            station.unload_controller(name)
    except StationError as error:
        problems.append(f"after the storm: {error.message}")
    if station.controllers():
        problems.append(f"after the storm: {station.controllers()} are loaded")
    observer.find_wrong_commands()
    return problems


def _sum(counts: Iterable[Counter[str]]) -> Counter[str]:
    return sum(counts, Counter())
