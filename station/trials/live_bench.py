"""Excite one joint of the running robot, and measure its response.

The set-points go through the running controller like those of a person, inside an
envelope that is small enough for an arm on a table: `LARGEST`, `FASTEST`, and the
limits of the joint. A joint may move faster than its set-point, e.g. near a resonance
of its loop, so the bench also limits the measured speeds (`SPEED_SHARE`).
"""

import math
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from station.core.control.controller import ControllerState
from station.core.errors import ControllerStateError, InvalidCommandError, suggest
from station.core.facade.station import Station
from station.core.ports.set_point import SetPointElement
from station.trials.bench_analysis import gain_names, joint_test
from station.trials.errors import (
    BenchRefusedError,
    ImpossibleRangeError,
    UnknownParameterError,
)
from station.trials.excitations import Array, least_jerk, offsets
from station.trials.metrics import Counts
from station.trials.reference import POSITION_UNITS, make_reference
from station.trials.trace import TraceRecorder
from station.trials.trial import Script
from station.wire.excitations import BenchRequest, BenchResponse, Relay, Step

LARGEST = {"rad": 0.3, "m": 0.03}
"""Largest offset from the initial position [rad or m], by the unit of the set-point."""
FASTEST = {"rad": 1.0, "m": 0.1}
"""Largest rate of an excitation without jumps [rad/s or m/s], by the unit of the
set-point."""
MARGIN = {"rad": 0.05, "m": 0.002}
"""Least distance of the set-point from the limits of the joint [rad or m], by the unit
of the set-point."""
SPEED_SHARE = 0.8
"""Share of a joint's velocity limit at which a measurement ends. An arm stops itself at
the limit, and under a relay of 0.3 rad a joint gains the last fifth within about 10 ms.
"""
_BEYOND = {"rad": 0.2, "m": 0.02}
"""How far the joint may overshoot the excitation before the measurement ends [rad or
m], by the unit of the set-point."""
_STILL = 0.05
"""Largest speed of a joint at which a measurement may begin [rad/s or m/s]."""
_TICK = 0.002
"""Time between two checks of the robot [s]."""
_PATIENCE = 1.0
"""Longest wait for the next cycle [s]."""
_SLOWEST = 4.0
"""Largest ratio of a measurement's wall time to its duration."""
_RETURN = 0.8
"""Duration of the motion back to the initial position [s]."""


class LiveBench:
    """Measures responses of the robot, one at a time. Any thread.

    Args:
        station: The station.
        sleep: Function that waits for a time [s].
        now: Monotonic clock [s].
    """

    def __init__(
        self,
        station: Station,
        sleep: Callable[[float], None] = time.sleep,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._station = station
        self._sleep = sleep
        self._now = now
        self._one_at_a_time = threading.Lock()

    def measure(
        self, controller: str, request: BenchRequest, admit: Callable[[], None]
    ) -> BenchResponse:
        """Excite a joint and return its response; the joint moves back afterwards.

        Args:
            controller: The controller, which runs and takes positions.
            request: Joint, excitation and duration.
            admit: Called before every set-point; raises an error when the caller may no
                longer move the robot.

        Raises:
            BenchRefusedError: Another measurement runs, a joint moves, or a joint
                left the envelope or came near its velocity limit meanwhile.
            ImpossibleRangeError: The excitation would leave the envelope.
            UnknownParameterError: The controller has no such joint.
            StationError: The controller takes no positions or does not run, the
                station is stopped, or the caller may not move the robot.
        """
        if not self._one_at_a_time.acquire(blocking=False):
            raise BenchRefusedError(
                "Another measurement is under way; the bench does one at a time.",
                remedy="Wait until it has ended.",
            )
        try:
            return self._measure(controller, request, admit)
        finally:
            self._one_at_a_time.release()

    def _measure(
        self, controller: str, request: BenchRequest, admit: Callable[[], None]
    ) -> BenchResponse:
        excitation = request.excitation
        begin, unit = self._check(controller, request)
        script = Script(
            controller=controller,
            duration=request.duration,
            commands=(excitation,),
            settling_band=request.settling_band,
        )
        admit()
        reference = make_reference(self._station, script, begin)
        recorder = TraceRecorder(self._station, controller)
        names = self._station.joint_names
        joint = names.index(excitation.joint)
        start = self._station.latest().position[joint]
        allowed = abs(excitation.amplitude) + _BEYOND[unit]
        fastest = self._fastest()
        first = self._station.loop.cycle
        cycles = max(1, round(request.duration / self._station.loop.period))
        deadline = self._now() + _PATIENCE + _SLOWEST * request.duration
        cycle, due = 0, -1
        try:
            with self._relay_gains(controller, request):
                gains = dict(self._station.tuning.gains(controller).values)
                # Ask before each set-point whether the caller holds control, because
                # the holder may change at any time.
                while cycle < cycles:
                    if cycle > due:
                        admit()
                        reference.command(cycle)
                        due = cycle
                    self._sleep(_TICK)
                    recorder.take()
                    cycle = self._station.loop.cycle - first
                    latest = self._station.latest()
                    self._check_speeds(latest.velocity, fastest)
                    self._check_on_the_way(
                        excitation.joint, latest.position[joint] - start, allowed
                    )
                    self._check_time(deadline)
        # Move the joint back before raising the error, because no caller would do it.
        except BenchRefusedError:
            self._brake(controller, begin, admit)
            self._go_back(controller, begin, admit)
            raise
        self._go_back(controller, begin, admit)
        trace = recorder.trace(is_live=True).of_joint(excitation.joint).until(cycles)
        found = joint_test(
            trace,
            excitation,
            script,
            gains,
            self._station.loop.hw.joint_limits(),
            Counts(recorder.reflexes),
        )
        return found.model_copy(update={"lost": recorder.lost})

    @contextmanager
    def _relay_gains(self, controller: str, request: BenchRequest) -> Iterator[None]:
        """Set the joint's i and d to 0 in the body of a `with`, if this is requested.

        Raises:
            ImpossibleRangeError: The controller has no such gains.
        """
        if request.relay_gain is None:
            yield
            return
        tuning = self._station.tuning
        gains = dict(tuning.gains(controller).values)
        names = gain_names(gains, request.excitation.joint)
        if not names or not isinstance(request.excitation, Relay):
            raise ImpossibleRangeError(
                f"`relay_gain` is the proportional gain of a relay test; this is a "
                f"{request.excitation.kind}, and '{controller}' has "
                f"{'a' if names else 'no'} gain p.",
                remedy="Leave `relay_gain` out, or choose a relay and a controller "
                "with PIDs.",
            )
        wanted = dict.fromkeys(names.values(), 0.0) | {names["p"]: request.relay_gain}
        # Set the gains before the joint moves. They are restored however the test ends,
        # and `remember=False` keeps them out of the undo history.
        tuning.set_gains(controller, wanted, remember=False)
        try:
            yield
        finally:
            before = {name: gains[name] for name in wanted}
            tuning.set_gains(controller, before, remember=False)

    def _check(self, controller: str, request: BenchRequest) -> tuple[list[float], str]:
        """Return the present set-point and the unit of the joint's element.

        Raises:
            ControllerStateError: The controller does not run.
            UnknownParameterError: The controller commands no such joint.
            BenchRefusedError: The controller has no set-point yet, or a joint moves
                now.
            StationError: The excitation is not possible.
        """
        station, excitation = self._station, request.excitation
        name = excitation.joint
        status = station.controller(controller)
        if status.state is not ControllerState.RUNNING:
            raise ControllerStateError(
                f"Controller '{controller}' is {status.state.value}, not running.",
                remedy="Start it first.",
            )
        elements = self._elements(controller)
        names = [element.name for element in elements]
        if name not in names or name not in station.joint_names:
            raise UnknownParameterError(
                f"Controller '{controller}' commands no joint '{name}'.",
                remedy=suggest(name, names),
                details={"joint": name},
            )
        element = elements[names.index(name)]
        sample = station.latest().samples.get(controller)
        if sample is None or len(sample.desired) != len(names):
            raise BenchRefusedError(
                f"The set-point of '{controller}' is not known yet.",
                remedy="Repeat the request.",
            )
        begin = list(sample.desired)
        self._check_still()
        self._check_envelope(request, element, begin[names.index(name)])
        return begin, element.unit

    def _elements(self, controller: str) -> list[SetPointElement]:
        """Return the commanded elements of a controller, which are joint positions.

        Raises:
            InvalidCommandError: The controller does not command positions of joints.
        """
        found = self._station.manager.get_controller(controller)
        if found.trajectories is not None:
            # A trajectory controller follows positions of its joints.
            return [SetPointElement(name, "rad") for name in found.joint_names]
        elements = [] if found.set_points is None else list(found.set_points.elements)
        if not elements or any(e.unit not in POSITION_UNITS for e in elements):
            raise InvalidCommandError(
                f"Controller '{controller}' takes no positions of joints.",
                remedy="Start a position controller, or one for trajectories.",
            )
        return elements

    def _check_still(self) -> None:
        """Refuse to measure while a joint moves.

        Raises:
            BenchRefusedError: A joint moves.
        """
        state = self._station.latest()
        for name, speed in zip(self._station.joint_names, state.velocity, strict=True):
            if abs(speed) > _STILL:
                raise BenchRefusedError(
                    f"Joint '{name}' moves with {speed:.3g} rad/s or m/s.",
                    remedy="Wait until the robot is at rest.",
                    details={"joint": name},
                )

    def _check_envelope(
        self, request: BenchRequest, element: SetPointElement, begin: float
    ) -> None:
        """Refuse an excitation that is too large, too fast or too near a limit.

        Raises:
            ImpossibleRangeError: The excitation leaves the envelope.
        """
        excitation, unit = request.excitation, element.unit
        period = self._station.loop.period
        cycles = max(2, round(request.duration / period))
        times: Array = np.arange(cycles, dtype=np.float64) * period
        ways = offsets(excitation, times, request.duration)
        low, high = float(ways.min()), float(ways.max())
        if isinstance(excitation, Relay):
            low, high = -abs(excitation.amplitude), abs(excitation.amplitude)
        rate = 0.0
        if not isinstance(excitation, Relay | Step):
            rate = float(np.abs(np.diff(ways)).max()) / period
        if low == high == 0.0:
            raise ImpossibleRangeError(
                "The excitation moves nothing: its amplitude is 0, or it begins after "
                f"the {request.duration:g} s of the measurement."
            )
        name = element.name
        for what, value, most, per in (
            ("go", max(-low, high), LARGEST[unit], unit),
            ("move with", rate, FASTEST[unit], f"{unit}/s"),
        ):
            if value > most:
                raise ImpossibleRangeError(
                    f"'{name}' would {what} {value:.3g} {per}; allowed are {most:g} "
                    f"{per}.",
                    remedy="Choose a smaller amplitude or lower frequencies.",
                    details={"joint": name, "value": value},
                )
        lowest, highest = self._range(element)
        if begin + low < lowest or begin + high > highest:
            raise ImpossibleRangeError(
                f"'{name}' would go from {begin + low:.3f} to {begin + high:.3f} "
                f"{unit}; allowed are {lowest:.3f} to {highest:.3f} {unit}.",
                remedy="Choose a smaller amplitude, or move the joint away from its "
                "limit.",
                details={"joint": name},
            )

    def _range(self, element: SetPointElement) -> tuple[float, float]:
        """Return the allowed range of a joint's set-point."""
        low, high = element.minimum, element.maximum
        for report in self._station.loop.hw.joint_limits():
            limits = report.limits
            if report.joint == element.name:
                if limits.min_position is not None:
                    low = max(low, limits.min_position)
                if limits.max_position is not None:
                    high = min(high, limits.max_position)
        return low + MARGIN[element.unit], high - MARGIN[element.unit]

    def _fastest(self) -> list[float]:
        """Return the speed of each joint that ends a measurement [rad/s or m/s]."""
        reports = self._station.loop.hw.joint_limits()
        limits = {report.joint: report.limits.max_velocity for report in reports}
        found = [limits.get(name) for name in self._station.joint_names]
        return [math.inf if limit is None else SPEED_SHARE * limit for limit in found]

    def _check_speeds(self, speeds: Sequence[float], fastest: list[float]) -> None:
        """End a measurement in which a joint comes near its velocity limit.

        Raises:
            BenchRefusedError: The joint leaves its envelope.
        """
        names = self._station.joint_names
        for name, speed, most in zip(names, speeds, fastest, strict=True):
            if abs(speed) > most:
                raise BenchRefusedError(
                    f"The measurement was ended: '{name}' moved with {abs(speed):.3g} "
                    f"rad/s or m/s; allowed are {most:.3g}, {SPEED_SHARE:.0%} of its "
                    "velocity limit.",
                    remedy="Choose a smaller amplitude, lower frequencies, or gains "
                    "that damp more.",
                    details={"joint": name, "speed": abs(speed)},
                )

    def _check_on_the_way(self, joint: str, moved: float, allowed: float) -> None:
        """End a measurement whose joint has moved too far.

        Raises:
            BenchRefusedError: The joint is too far from its start.
        """
        if abs(moved) > allowed:
            raise BenchRefusedError(
                f"The measurement was ended: '{joint}' was {abs(moved):.3g} "
                f"away from where it began; allowed are {allowed:.3g}.",
                remedy="The loop may be unstable: choose other gains, or a smaller "
                "amplitude.",
                details={"joint": joint},
            )

    def _check_time(self, deadline: float) -> None:
        """End a measurement in which station time does not pass.

        Raises:
            BenchRefusedError: The deadline has passed.
        """
        if self._now() > deadline:
            raise BenchRefusedError(
                "The measurement was ended: the cycles are too slow.",
                remedy="Resume a paused simulation, and let it run at full speed.",
            )

    def _brake(
        self, controller: str, begin: list[float], admit: Callable[[], None]
    ) -> None:
        """Make the present positions the set-points, in place of those farther away."""
        station = self._station
        if station.manager.get_controller(controller).trajectories is None:
            here = dict(
                zip(station.joint_names, station.latest().position, strict=True)
            )
            names = [element.name for element in self._elements(controller)]
            pairs = zip(names, begin, strict=True)
            admit()
            station.motion.set_command(controller, [here.get(n, b) for n, b in pairs])
            self._settle()

    def _go_back(
        self, controller: str, begin: list[float], admit: Callable[[], None]
    ) -> None:
        """Move the set-point back to its initial value, smoothly."""
        station = self._station
        found = station.manager.get_controller(controller)
        if found.trajectories is not None:
            station.motion.hold(controller)
            self._settle()
            return
        sample = station.latest().samples.get(controller)
        start = begin if sample is None else list(sample.desired)
        began = station.loop.time
        deadline = self._now() + _SLOWEST * _RETURN
        share = 0.0
        while share < 1.0 and self._now() < deadline:
            share = min(1.0, (station.loop.time - began) / _RETURN)
            way = float(least_jerk(np.array(share)))
            admit()
            values = [a + (b - a) * way for a, b in zip(start, begin, strict=True)]
            station.motion.set_command(controller, values)
            self._sleep(_TICK)
        self._settle()

    def _settle(self) -> None:
        """Wait until the robot is at rest, for `_RETURN` at most."""
        deadline = self._now() + _RETURN
        until = self._station.loop.time + _RETURN
        while self._now() < deadline and self._station.loop.time < until:
            if max(map(abs, self._station.latest().velocity), default=0.0) < _STILL:
                return
            self._sleep(_TICK)
