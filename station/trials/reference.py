"""Give a controller the commands of a script, cycle by cycle."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from typing_extensions import override

from station.core.errors import InvalidCommandError, suggest
from station.core.facade.station import Station
from station.core.ports.set_point import SetPointElement
from station.trials.errors import ExperimentError, UnknownParameterError
from station.trials.excitations import Array, offsets
from station.trials.trial import Script
from station.wire.excitations import Motion, Recorded, Relay, Step

NEVER = 2**62
"""A cycle number that is never reached."""
_POINT_CYCLES = 20
"""Cycles between two points of a trajectory."""
_DIFFERENCE = 1e-4
"""Half of the interval over which rates of a trajectory are computed [s]."""
_REPEAT = 20
"""Cycles after which a set-point is sent again: without it streaming controllers brake.
"""
POSITION_UNITS = frozenset({"rad", "m"})
"""Units of set-points that are positions."""


class Reference(ABC):
    """The motion that a trial commands to a controller."""

    @abstractmethod
    def command(self, cycle: int) -> None:
        """Give the controller the command that is due before a cycle.

        Args:
            cycle: Number of the cycle in the trial, from 0, increasing.

        Raises:
            StationError: The controller refuses the command.
        """

    @abstractmethod
    def quiet_from(self, cycle: int) -> int:
        """Return the first cycle after `cycle` for which a command may be due."""


class _Hold(Reference):
    """Gives no commands, so that the controller holds."""

    @override
    def command(self, cycle: int) -> None:
        """Give no command."""

    @override
    def quiet_from(self, cycle: int) -> int:
        return NEVER


class _SetPoints(Reference):
    """Sends the set-point when it changes, and in every cycle while a relay acts."""

    def __init__(
        self, facade: Station, script: Script, begin: Sequence[float] | None
    ) -> None:
        self._facade = facade
        self._controller = script.controller
        elements = facade.motion.set_point(script.controller).elements
        names = [element.name for element in elements]
        if begin is None:
            begin = [_begin(facade, script.controller, element) for element in elements]
        period = facade.loop.period
        times: Array = _ticks(max(1, round(script.duration / period)), period)
        values: Array = np.tile(np.array(begin), (len(times), 1))
        self._relays: list[_RelaySwitch] = []
        for motion in script.motions:
            column = _column(motion, names)
            values[:, column] += offsets(motion, times, script.duration)
            if isinstance(motion, Relay):
                self._relays.append(_RelaySwitch(facade, motion, column))
        self._values = values
        changes = np.flatnonzero(np.any(np.diff(values, axis=0) != 0.0, axis=1)) + 1
        self._changes = np.concatenate(([0], changes))
        self._sent = -1  # index of the change that was sent last

    @override
    def command(self, cycle: int) -> None:
        newest = int(np.searchsorted(self._changes, cycle, side="right")) - 1
        is_due = newest > self._sent
        if not (is_due or self._relays or cycle % _REPEAT == 0):
            return
        self._sent = newest
        values = self._values[cycle].tolist()
        for relay in self._relays:
            values[relay.column] += relay.offset(cycle)
        self._facade.motion.set_command(self._controller, values)

    @override
    def quiet_from(self, cycle: int) -> int:
        if self._relays:
            return cycle + 1
        index = int(np.searchsorted(self._changes, cycle, side="right"))
        change = int(self._changes[index]) if index < len(self._changes) else NEVER
        return min(change, cycle + _REPEAT - cycle % _REPEAT)


class _RelaySwitch:
    """Computes the offset of a relay from the measured position of its joint."""

    def __init__(self, facade: Station, relay: Relay, column: int) -> None:
        self._facade, self._relay = facade, relay
        self._joint = _measured(facade, relay.joint)
        # For a set-point of velocity or effort, the middle is the joint's initial
        # position.
        self._middle = facade.latest().position[self._joint]
        self._first = round(relay.at / facade.loop.period)
        self._side = 1.0
        self.column = column

    def offset(self, cycle: int) -> float:
        """Return the offset for a cycle."""
        if cycle < self._first:
            return 0.0
        way = self._facade.latest().position[self._joint] - self._middle
        if way * self._side > self._relay.hysteresis:
            self._side = -self._side
        return self._side * self._relay.amplitude


class _Trajectory(Reference):
    """One trajectory through the motions of the whole script."""

    def __init__(self, facade: Station, script: Script) -> None:
        self._facade = facade
        self._controller = script.controller
        names = list(facade.manager.get_controller(script.controller).joint_names)
        begin = np.array(facade.motion.query_state(script.controller).position)
        count = max(1, int(script.duration / (_POINT_CYCLES * facade.loop.period)))
        times: Array = _ticks(count + 1, script.duration / count)[1:]
        around: list[Array] = [
            np.tile(begin, (len(times), 1)) for _ in range(3)
        ]  # times before, at and after each point
        for motion in script.motions:
            is_held = isinstance(motion, Recorded) and motion.between == "hold"
            if is_held or isinstance(motion, Step | Relay):
                raise ExperimentError(
                    f"Controller '{script.controller}' follows trajectories, which "
                    f"have no jumps; the script has a {motion.kind}.",
                    remedy="Use waypoints, sine, chirp, multisine or what was recorded "
                    "with `between: smooth`, or a controller that takes set-points.",
                )
            column = _column(motion, names)
            for values, shift in zip(around, (-1, 0, 1), strict=True):
                at = times + shift * _DIFFERENCE
                values[:, column] += offsets(motion, at, script.duration)
        self._request = {
            "joint_names": names,
            "points": _points(times, *around),
        }

    @override
    def command(self, cycle: int) -> None:
        if cycle == 0:
            self._facade.motion.follow_trajectory(self._controller, self._request)

    @override
    def quiet_from(self, cycle: int) -> int:
        return NEVER


def make_reference(
    facade: Station, script: Script, begin: Sequence[float] | None = None
) -> Reference:
    """Return the object that gives the commands of a script to its controller.

    Args:
        facade: The station.
        script: Commands of the trial.
        begin: Set-point to which the script's offsets are added; None for the present
            positions. Trajectories begin at the desired state.

    Raises:
        ExperimentError: The controller cannot follow the script.
        UnknownParameterError: The controller has no such joint.
        InvalidCommandError: The controller takes neither set-points nor trajectories.
    """
    if not script.motions:
        return _Hold()
    controller = facade.manager.get_controller(script.controller)
    if controller.trajectories is not None:
        return _Trajectory(facade, script)
    if controller.set_points is None:
        raise InvalidCommandError(
            f"Controller '{script.controller}' takes neither set-points nor "
            "trajectories.",
            remedy="Choose another controller, or a script of pushes alone.",
        )
    return _SetPoints(facade, script, begin)


def _ticks(count: int, period: float) -> Array:
    """Return the times of the first cycles, from 0 [s], shape (count,)."""
    return np.array([tick * period for tick in range(count)])


def _begin(facade: Station, controller: str, element: SetPointElement) -> float:
    """Return the value of a set-point's element at which nothing moves.

    Raises:
        ExperimentError: The element is a position, but not of a joint.
    """
    if element.unit not in POSITION_UNITS:
        return 0.0  # zero velocity or zero effort
    names = facade.joint_names
    if element.name in names:
        return facade.latest().position[names.index(element.name)]
    raise ExperimentError(
        f"The set-point of '{controller}' has '{element.name}', which is the position "
        "of no joint; a script cannot move it.",
        remedy="Choose a controller of joints.",
    )


def _column(motion: Motion, names: list[str]) -> int:
    """Return the index of the element of the set-point that a motion changes.

    Raises:
        UnknownParameterError: The controller has no such joint.
    """
    if motion.joint not in names:
        raise UnknownParameterError(
            f"The controller has no joint '{motion.joint}'.",
            remedy=suggest(motion.joint, names),
            details={"joint": motion.joint},
        )
    return names.index(motion.joint)


def _measured(facade: Station, joint: str) -> int:
    """Return the index of a measured joint.

    Raises:
        UnknownParameterError: The robot does not measure this joint.
    """
    if joint not in facade.joint_names:
        raise UnknownParameterError(
            f"The robot measures no joint '{joint}', which a relay needs.",
            remedy=suggest(joint, facade.joint_names),
        )
    return facade.joint_names.index(joint)


def _points(
    times: Array, before: Array, here: Array, after: Array
) -> list[dict[str, object]]:
    """Return the points of a trajectory that ends at rest."""
    velocities = (after - before) / (2.0 * _DIFFERENCE)
    accelerations = (after - 2.0 * here + before) / _DIFFERENCE**2
    velocities[-1] = accelerations[-1] = 0.0
    return [
        {
            "positions": q.tolist(),
            "velocities": dq.tolist(),
            "accelerations": ddq.tolist(),
            "time_from_start": float(time),
        }
        for time, q, dq, ddq in zip(times, here, velocities, accelerations, strict=True)
    ]
