"""Motions near a pose, and commands that an arm must refuse.

A stream is called once per cycle with the cycle's number, see `Stream`. Cycles
are 1 ms, and a stream leaves nothing out when the client misses a state.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Any, TypeAlias

import numpy as np

from station.core.numerics.poses import displace
from station.hw.franka.fci.wire.robot_protocol import MoveController, MoveGenerator

JOINTS = MoveController.JOINT_IMPEDANCE
CARTESIAN = MoveController.CARTESIAN_IMPEDANCE
CYCLE = 0.001
"""Time from one state to the next [s]."""
START = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""The pose at which the checks begin [rad]; libfranka's examples begin there."""
_LONGEST = 4000  # cycles of a motion
QUIET = 50
"""Cycles at rest before `step` and `ramp`."""
State: TypeAlias = Mapping[str, Any]
"""The fields of a state by their names on the wire."""
Fields: TypeAlias = Mapping[str, Any]
"""Fields of a command; those that are left out are zero."""
Stream: TypeAlias = Callable[[int, State, State], Fields | None]
"""Function of a cycle (from 0), its state, and the first state of the motion, that
returns the command; None sends none.
"""
Way: TypeAlias = Callable[[int], float]
"""Function that returns a number for a cycle, e.g. a distance from the start."""
Ways: TypeAlias = Callable[[int], Sequence[float]]
"""Function that returns a vector for a cycle."""


@dataclass(frozen=True, slots=True)
class Motion:
    """The modes and the commands of a motion.

    Attributes:
        controller: The controller.
        generator: The motion generator; `NONE` for torques only.
        stream: The commands.
    """

    controller: MoveController
    generator: MoveGenerator
    stream: Stream

    def without(self, is_left_out: Callable[[int], bool]) -> "Motion":
        """Return the motion without the commands of some cycles."""

        def thinned(cycle: int, *states: State) -> Fields | None:
            return None if is_left_out(cycle) else self.stream(cycle, *states)

        return replace(self, stream=thinned)


def smooth(part: float) -> float:
    """Return the share of a rest-to-rest motion with bounded jerk that is done.

    Args:
        part: Share of its time that has passed, 0 to 1.
    """
    part = min(max(part, 0.0), 1.0)
    return part**3 * (10.0 - 15.0 * part + 6.0 * part**2)


def there_and_back(way: float, cycles: int) -> Way:
    """Return a motion by a distance and back, from rest to rest; see `smooth`."""
    return lambda n: way * (smooth(2.0 * n / cycles) - smooth(2.0 * n / cycles - 1.0))


def rate(way: Way) -> Way:
    """Return the velocity of a motion from one cycle to the next, per second."""
    return lambda n: (way(n) - way(n - 1)) / CYCLE if n else 0.0


def step(value: float) -> Way:
    """Return a function that is 0 in the cycles at rest, and `value` afterwards."""
    return lambda n: value if n >= QUIET else 0.0


def ramp(acceleration: float, jerk: float, velocity: float) -> Way:
    """Return a distance that grows ever faster, after the cycles at rest.

    Args:
        acceleration: Largest acceleration, per second squared.
        jerk: Largest jerk, per second cubed; inf lets the acceleration jump.
        velocity: Velocity at which the acceleration ends, per second.
    """
    speeds, ways = [0.0], [0.0]
    for cycle in range(1, _LONGEST):
        grows = min(acceleration, jerk * cycle * CYCLE)
        speeds.append(min(velocity, speeds[-1] + grows * CYCLE))
        ways.append(ways[-1] + speeds[-1] * CYCLE)
    return lambda n: ways[max(0, n - QUIET)]


def along(axis: int, way: Way, size: int = 7, factor: float = 1.0) -> Ways:
    """Return a motion of one joint, or along one axis, as a vector function."""
    return lambda n: [factor * way(n) if i == axis else 0.0 for i in range(size)]


def joint_positions(way: Ways) -> Motion:
    """Return a motion of joint positions.

    Args:
        way: Returns the distance from the first `q_d` in a cycle [rad], shape (7,).
    """

    def stream(cycle: int, _state: State, begin: State) -> Fields:
        return {"q_c": np.add(begin["q_d"], way(cycle))}

    return Motion(JOINTS, MoveGenerator.JOINT_POSITION, stream)


def glide(way: Sequence[float], cycles: int) -> Motion:
    """Return a motion of the joints from rest to rest, by a distance [rad], (7,)."""
    return joint_positions(lambda n: [smooth(n / cycles) * one for one in way])


def rest(_cycle: int) -> Sequence[float]:
    """Return no distance, no velocity and no torque, shape (7,)."""
    return (0.0,) * 7


HOLD = joint_positions(rest)
"""A motion that stays at the first position."""


def poses(
    shift: Ways = lambda _n: (0.0,) * 3,
    angle: Way = lambda _n: 0.0,
    elbow: tuple[float, float] | None = None,
) -> Motion:
    """Return a motion of poses of the end effector.

    Args:
        shift: Returns the distance from the first pose in a cycle, in the base frame
            [m], shape (3,).
        angle: Returns the turn about the z axis of the end effector [rad].
        elbow: Distance of the elbow from its present position [rad], and factor of its
            sign; None commands no elbow.
    """

    def stream(cycle: int, _state: State, begin: State) -> Fields:
        pose = begin["O_T_EE_c"]
        turn = [angle(cycle) * axis for axis in pose[8:11]]
        fields = {"O_T_EE_c": displace(pose, shift(cycle), turn)}
        if elbow is None:
            return fields
        joint, sign = begin["elbow_d"]
        commanded = [joint + elbow[0], sign * elbow[1]]
        return {**fields, "elbow_c": commanded, "valid_elbow": True}

    return Motion(CARTESIAN, MoveGenerator.CARTESIAN_POSITION, stream)


def maker_of(
    field: str, controller: MoveController, generator: MoveGenerator
) -> Callable[[Ways], Motion]:
    """Return a function that makes a motion of the values of a field in each cycle."""
    return lambda way: Motion(controller, generator, lambda n, *_: {field: way(n)})


joint_velocities = maker_of("dq_c", JOINTS, MoveGenerator.JOINT_VELOCITY)
"""Makes a motion of joint velocities, shape (7,) [rad/s]."""
twists = maker_of("O_dP_EE_c", CARTESIAN, MoveGenerator.CARTESIAN_VELOCITY)
"""Makes a motion of twists of the end effector, shape (6,) [m/s, rad/s]."""
torques = maker_of("tau_J_d", MoveController.EXTERNAL_CONTROLLER, MoveGenerator.NONE)
"""Makes a motion of torques only, shape (7,) [Nm]."""


def farthest(one: Iterable[float], other: Iterable[float]) -> float:
    """Return the largest difference between two vectors."""
    return max(abs(a - b) for a, b in zip(one, other, strict=True))
