"""Pause, step, reset and the speed of a simulated robot, for any thread.

Controllers stay loaded and running; commands from before a reset are void.
"""

import math
from collections.abc import Mapping

from station.core.errors import ParameterError, SimulationError, counted, suggest
from station.core.facade.input_log import InputLog
from station.core.hardware.limits import JointLimits
from station.core.hardware.robot_hw import SimulatedWorld
from station.core.loop.control_loop import ControlLoop
from station.core.loop.simulation_speed import check_real_time_factor
from station.reports import LoopState, Simulation

MOST_STEPS = 10_000
"""Largest number of cycles of one `step`; ten seconds at 1 kHz."""
# Interval at which a waiting `step` looks at the loop [s], and its patience beyond
# twice the nominal time [s].
_WAKE = 0.002
_GRACE = 2.0


class SimulationControl:
    """Controls the speed of one loop and the world of its robot.

    Every method but `find` refuses a robot that is not simulated.

    Args:
        loop: The loop.
        inputs: Receives every reset.
    """

    def __init__(self, loop: ControlLoop, inputs: InputLog | None = None) -> None:
        self._inputs = inputs or InputLog(loop)
        self._loop = loop
        self._world = loop.hw.simulated_world()

    def find(self) -> Simulation | None:
        """Return the state of the simulation; None if the robot is real."""
        if self._world is None:
            return None
        time, speed = self._world.time(), self._loop.speed
        return Simulation(
            speed.paused,
            speed.real_time_factor,
            time,
            speed.steps_due,
            tuple(self._world.keyframes()),
        )

    def report(self) -> Simulation:
        """Return the state of the simulation.

        Raises:
            SimulationError: The robot is not simulated.
        """
        report = self.find()
        if report is None:
            raise self._refusal()
        return report

    def change(
        self, *, paused: bool | None = None, real_time_factor: float | None = None
    ) -> Simulation:
        """Pause or resume, and change the speed; None leaves a value as it is.

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
        speed = self._loop.speed

        def apply() -> None:
            if real_time_factor is not None and real_time_factor != (
                speed.real_time_factor
            ):
                speed.real_time_factor = real_time_factor
                self._loop.begin_statistics()
            if paused:
                speed.paused = True
            elif paused is not None:
                speed.resume()

        self._loop.run_in_cycle(apply)
        return self.report()

    def step(self, cycles: int = 1) -> Simulation:
        """Run some cycles of a paused simulation; return when they are done.

        The cycles run one after another at the speed of the loop.

        Args:
            cycles: Number of cycles, 1 to `MOST_STEPS`.

        Raises:
            ParameterError: `cycles` is out of range.
            SimulationError: The simulation is not paused, or was resumed meanwhile.
            LoopError: The loop died or hangs.
        """
        self.report()
        if not 1 <= cycles <= MOST_STEPS:
            raise ParameterError(
                f"A step of {counted(cycles, 'cycle')} is not possible; allowed are 1 "
                f"to {MOST_STEPS}.",
                remedy="Step several times, or resume the simulation.",
                details={"n": cycles},
            )
        loop, speed = self._loop, self._loop.speed

        def begin() -> None:
            if not speed.paused:
                raise SimulationError(
                    "The simulation is not paused.",
                    remedy="Pause the simulation first.",
                )
            speed.steps_due += cycles

        loop.run_in_cycle(begin)
        if loop.state is not LoopState.RUNNING:
            loop.step(speed.steps_due)
            speed.steps_due = 0
            return self.report()
        self._wait_for_steps(cycles)
        return self.report()

    def reset(
        self,
        positions: Mapping[str, float] | None = None,
        keyframe: str | None = None,
    ) -> Simulation:
        """Put the world back to its start; running controllers start anew from there.

        A new epoch begins: set-points and goals from before are void.

        Args:
            positions: Joint name to position [rad or m]; joints that are not named go
                back to where they began.
            keyframe: Pose in which the joints begin that `positions` does not name.

        Raises:
            ParameterError: There is no such keyframe, or a joint is unknown or would be
                outside its limits; nothing changed.
            LoopError: The loop died or hangs.
        """
        loop, world = self._loop, self._world
        if world is None:
            raise self._refusal()
        wanted = {**self._keyframe(world, keyframe), **(positions or {})}
        self._check_positions(wanted)

        def apply() -> None:
            world.reset(wanted)
            loop.control_cycle.begin_anew()
            self._inputs.note_in_cycle("reset", positions=wanted)

        loop.run_in_cycle(apply)
        return self.report()

    def _keyframe(self, world: SimulatedWorld, name: str | None) -> Mapping[str, float]:
        """Return the positions of a keyframe; empty without a name.

        Raises:
            ParameterError: There is no such keyframe.
        """
        keyframes = world.keyframes()
        if name is None:
            return {}
        if name not in keyframes:
            raise ParameterError(
                f"The simulated world has no keyframe '{name}'.",
                remedy=suggest(name, keyframes),
                details={"keyframe": name},
            )
        return keyframes[name]

    def _refusal(self) -> SimulationError:
        return SimulationError(
            f"The robot {type(self._loop.hw).__name__} is not simulated.",
            remedy="Nobody can stop its time; stop the robot instead.",
        )

    def _check_positions(self, positions: Mapping[str, float]) -> None:
        hw = self._loop.hw
        known = hw.resources()
        limits = {report.joint: report.limits for report in hw.joint_limits()}
        for joint, position in positions.items():
            if joint not in known:
                raise ParameterError(
                    f"The simulated world has no joint '{joint}'.",
                    remedy=suggest(joint, self._loop.joint_names),
                    details={"joint": joint},
                )
            lower, upper = _range(limits.get(joint))
            if not (math.isfinite(position) and lower <= position <= upper):
                raise ParameterError(
                    f"Joint '{joint}' cannot be put to {position}; allowed are "
                    f"{lower:g} to {upper:g}.",
                    remedy="The report of the hardware has the limits of all joints.",
                    details={"joint": joint, "position": position},
                )

    def _wait_for_steps(self, cycles: int) -> None:
        loop, speed = self._loop, self._loop.speed
        wall = cycles * loop.period / speed.real_time_factor
        deadline = loop.clock.now() + 2.0 * wall + _GRACE
        while speed.steps_due > 0 and loop.clock.now() < deadline:
            loop.check_alive()
            loop.clock.sleep_until(loop.clock.now() + _WAKE)
        if speed.steps_due > 0:
            raise SimulationError(
                f"{speed.steps_due} cycles of the step have not run yet.",
                remedy="The loop may be late, or another client may be stepping, too; "
                "look at the report of the loop.",
            )


def _range(limits: JointLimits | None) -> tuple[float, float]:
    lower = None if limits is None else limits.min_position
    upper = None if limits is None else limits.max_position
    return (
        -math.inf if lower is None else lower,
        math.inf if upper is None else upper,
    )
