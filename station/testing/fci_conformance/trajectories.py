"""Streams of commands: slow motions near a pose, and what an arm must refuse.

A stream is called once per cycle with the cycle's number, see `dialog.Stream`. Cycles
are 1 ms, and a stream leaves nothing out when the client misses a state.
"""

from collections.abc import Callable, Sequence
from math import cos, sin

from station.testing.fci_conformance.dialog import Fields, State, Stream

CYCLE = 0.001
"""Time from one state to the next [s]."""


def smooth(part: float) -> float:
    """Return the part of a way that is done, from rest to rest with bounded jerk.

    Args:
        part: Part of the time, 0 to 1.
    """
    part = min(max(part, 0.0), 1.0)
    return part**3 * (10.0 - 15.0 * part + 6.0 * part**2)


def there_and_back(part: float) -> float:
    """Return a way of 1 and back to 0, from rest to rest; see `smooth`."""
    return smooth(2.0 * part) - smooth(2.0 * part - 1.0)


class Ramp:
    """A velocity that grows with bounded acceleration and jerk, and the way it makes.

    Args:
        acceleration: Largest acceleration, per second squared.
        jerk: Largest jerk, per second cubed; 0 lets the acceleration jump.
        velocity: Velocity at which it ceases to grow, per second.

    Attributes:
        way: The way since the beginning.
        velocity: The velocity now, per second.
    """

    def __init__(self, acceleration: float, jerk: float, velocity: float) -> None:
        self._most, self._jerk, self._top = acceleration, jerk, velocity
        self._rate = 0.0
        self._cycle = -1
        self.way = self.velocity = 0.0

    def advance(self, cycle: int) -> "Ramp":
        """Go on to a cycle; the first one is at rest."""
        while self._cycle < cycle:
            self._cycle += 1
            if not self._cycle:
                continue
            step = self._jerk * CYCLE if self._jerk else self._most
            self._rate = min(self._most, self._rate + step)
            left = max(0.0, self._top - self.velocity)
            self.velocity += min(self._rate * CYCLE, left)
            self.way += self.velocity * CYCLE
        return self


def begin_of(field: str) -> Callable[[State], tuple[float, ...]]:
    """Return a function that keeps a field of the first state that it is given."""
    kept: list[tuple[float, ...]] = []

    def first(state: State) -> tuple[float, ...]:
        if not kept:
            kept.append(tuple(state[field]))
        return kept[0]

    return first


def joint_positions(way: Callable[[int], Sequence[float]]) -> Stream:
    """Return a stream of joint positions.

    Args:
        way: Returns the way from the first `q_d` in a cycle [rad], shape (7,).
    """
    begin = begin_of("q_d")

    def stream(cycle: int, state: State) -> Fields:
        pairs = zip(begin(state), way(cycle), strict=True)
        return {"q_c": [q + offset for q, offset in pairs]}

    return stream


def joint_velocities(velocity: Callable[[int], Sequence[float]]) -> Stream:
    """Return a stream of joint velocities, shape (7,) [rad/s]."""
    return lambda cycle, _state: {"dq_c": list(velocity(cycle))}


def poses(
    shift: Callable[[int], Sequence[float]],
    angle: Callable[[int], float] = lambda _cycle: 0.0,
) -> Stream:
    """Return a stream of poses of the end effector.

    Args:
        shift: Returns the way from the first pose in a cycle, in the base [m], (3,).
        angle: Returns the turn about the z axis of the end effector [rad].
    """
    begin = begin_of("O_T_EE_c")

    def stream(cycle: int, state: State) -> Fields:
        pose = list(begin(state))
        x, y = pose[0:3], pose[4:7]
        c, s = cos(angle(cycle)), sin(angle(cycle))
        pose[0:3] = [c * a + s * b for a, b in zip(x, y, strict=True)]
        pose[4:7] = [c * b - s * a for a, b in zip(x, y, strict=True)]
        for i, way in enumerate(shift(cycle)):
            pose[12 + i] += way
        return {"O_T_EE_c": pose}

    return stream


def twists(twist: Callable[[int], Sequence[float]]) -> Stream:
    """Return a stream of twists of the end effector, shape (6,) [m/s, rad/s]."""
    return lambda cycle, _state: {"O_dP_EE_c": list(twist(cycle))}


def torques(torque: Callable[[int], float], joint: int = 6) -> Stream:
    """Return a stream of torques of one joint [Nm]; the others have none.

    The fields of a joint velocity motion are zero: before version 7 a torque motion is
    one of them. Source: libfranka@0.9.2 src/robot.cpp, Robot::control.
    """
    return lambda cycle, _state: {
        "tau_J_d": [torque(cycle) if i == joint else 0.0 for i in range(7)]
    }


def one_joint(joint: int, value: float) -> list[float]:
    """Return numbers of seven joints, all zero but one."""
    return [value if i == joint else 0.0 for i in range(7)]


def along(axis: int, value: float, size: int = 3) -> list[float]:
    """Return a vector along an axis; of size 6 it is a twist."""
    return [value if i == axis else 0.0 for i in range(size)]
