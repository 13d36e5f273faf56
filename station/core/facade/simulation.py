"""Pause, step, reset and the pace of a simulated robot, for any thread.

Controllers survive all of it, and whatever was commanded before a reset is void.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from station.core.errors import ParameterError, SimulationError
from station.core.hardware.limits import JointLimits
from station.core.loop.control_loop import ControlLoop
from station.core.loop.loop_report import LoopState
from station.core.loop.pace import check_real_time_factor

MOST_STEPS = 10_000
"""Most cycles of one `step`: at the usual rate ten seconds."""
_WAKE = 0.002
_GRACE = 2.0


@dataclass(frozen=True, slots=True)
class SimulationReport:
    """The simulation at a glance.

    Attributes:
        paused: Station time stands still.
        real_time_factor: Station time over wall time, as asked for.
        time: Time of the simulated world [s]; a reset sets it to zero.
        steps_due: Cycles that are still to be run while paused.
    """

    paused: bool
    real_time_factor: float
    time: float
    steps_due: int


class Simulation:
    """Commands the pace of one loop and the world of its robot.

    Every method refuses a robot that is not simulated.

    Args:
        loop: The loop.
    """

    def __init__(self, loop: ControlLoop) -> None:
        self._loop = loop

    def find(self) -> SimulationReport | None:
        """Return the simulation at a glance; None when the robot is real."""
        time, pace = self._loop.hw.simulated_time(), self._loop.pace
        if time is None:
            return None
        return SimulationReport(
            pace.paused, pace.real_time_factor, time, pace.steps_due
        )

    def report(self) -> SimulationReport:
        """Return the simulation at a glance.

        Raises:
            SimulationError: The robot is not simulated.
        """
        report = self.find()
        if report is None:
            raise SimulationError(
                f"The robot {type(self._loop.hw).__name__} is not simulated.",
                remedy="Time cannot be stopped for it; POST /stop stops the robot.",
            )
        return report

    def change(
        self, *, paused: bool | None = None, real_time_factor: float | None = None
    ) -> SimulationReport:
        """Pause or resume, and change the pace; None leaves things as they are.

        Args:
            paused: Whether station time is to stand still.
            real_time_factor: Station time over wall time, 0.01 to 100.

        Raises:
            ParameterError: The factor is out of range; nothing changed.
            LoopError: The loop died or hangs.
        """
        self.report()
        if real_time_factor is not None:
            check_real_time_factor(real_time_factor)
        pace = self._loop.pace

        def apply() -> None:
            if real_time_factor is not None and real_time_factor != (
                pace.real_time_factor
            ):
                pace.real_time_factor = real_time_factor
                self._loop.begin_statistics()
            if paused:
                pace.paused = True
            elif paused is not None:
                pace.resume()

        self._loop.run_in_cycle(apply)
        return self.report()

    def step(self, cycles: int = 1) -> SimulationReport:
        """Run some cycles of a paused simulation; return when they are done.

        They come at the pace of the loop, one after each other.

        Args:
            cycles: How many, 1 … `MOST_STEPS`.

        Raises:
            ParameterError: `cycles` is out of range.
            SimulationError: It is not paused, or was resumed meanwhile.
            LoopError: The loop died or hangs.
        """
        self.report()
        if not 1 <= cycles <= MOST_STEPS:
            raise ParameterError(
                f"{cycles} cycles were asked for; allowed are 1 to {MOST_STEPS}.",
                remedy="Step several times, or resume.",
                details={"n": cycles},
            )
        loop, pace = self._loop, self._loop.pace

        def begin() -> None:
            if not pace.paused:
                raise SimulationError(
                    "The simulation is not paused.",
                    remedy="Pause it first: PATCH /simulation with paused: true.",
                )
            pace.steps_due += cycles

        loop.run_in_cycle(begin)
        if loop.state is not LoopState.RUNNING:
            loop.step(pace.steps_due)
            pace.steps_due = 0
            return self.report()
        self._wait_for_steps(cycles)
        return self.report()

    def reset(self, positions: Mapping[str, float] | None = None) -> SimulationReport:
        """Put the world back to its start; running controllers start anew from there.

        A new epoch begins: set-points and goals from before are void.

        Args:
            positions: Joint name to position [rad or m]; the other joints go
                back to where they began.

        Raises:
            ParameterError: A joint is unknown, or would be outside of its limits;
                nothing changed.
            LoopError: The loop died or hangs.
        """
        self.report()
        loop = self._loop
        wanted = dict(positions or {})
        self._check_positions(wanted)

        def apply() -> None:
            loop.hw.reset_simulation(wanted)
            loop.begin_anew()

        loop.run_in_cycle(apply)
        return self.report()

    def _check_positions(self, positions: Mapping[str, float]) -> None:
        hw = self._loop.hw
        known = hw.resources()
        limits = {report.joint: report.limits for report in hw.joint_limits()}
        for joint, position in positions.items():
            if joint not in known:
                raise ParameterError(
                    f"The simulated world has no joint '{joint}'.",
                    remedy=f"Joints are: {', '.join(self._loop.joint_names)}.",
                    details={"joint": joint},
                )
            lower, upper = _range(limits.get(joint))
            if not (math.isfinite(position) and lower <= position <= upper):
                raise ParameterError(
                    f"Joint '{joint}' cannot be put to {position}; allowed are "
                    f"{lower:g} to {upper:g}.",
                    remedy="GET /hardware has the limits of all joints.",
                    details={"joint": joint, "position": position},
                )

    def _wait_for_steps(self, cycles: int) -> None:
        loop, pace = self._loop, self._loop.pace
        wall = cycles * loop.period / pace.real_time_factor
        deadline = loop.clock.now() + 2.0 * wall + _GRACE
        while pace.steps_due > 0 and loop.clock.now() < deadline:
            loop.check_alive()
            loop.clock.sleep_until(loop.clock.now() + _WAKE)
        if pace.steps_due > 0:
            raise SimulationError(
                f"{pace.steps_due} of the cycles asked for are still to be run.",
                remedy="GET /loop says how the loop does; others may be stepping, too.",
            )


def _range(limits: JointLimits | None) -> tuple[float, float]:
    lower = None if limits is None else limits.min_position
    upper = None if limits is None else limits.max_position
    return (
        -math.inf if lower is None else lower,
        math.inf if upper is None else upper,
    )
