"""Walls before the position limits of joints: a damper, then a damper and a spring.

Source: franka_ros@c11f000 franka_example_controllers, src/joint_wall.cpp; differs: a
joint beyond its limits is refused at the start instead of ending the process, and a
restart computes the width of the walls again.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from station.core.errors import ControllerStateError


@dataclass(frozen=True, slots=True)
class WallShape:
    """The wall at each end of a joint's range.

    Attributes:
        spring_width: Width of the spring zone next to the limit, in which spring and
            damper act [rad].
        damper_width: Width of the damper zone before the spring zone [rad].
        stiffness: Stiffness of the spring [Nm/rad].
        spring_damping: Damping in the spring zone [Nms/rad].
        damping: Damping in the damper zone [Nms/rad].
    """

    spring_width: float
    damper_width: float
    stiffness: float
    spring_damping: float
    damping: float


class JointWall:
    """The walls of one joint. Control thread only.

    A joint that starts inside of a wall is not pushed out of it: the wall is narrowed
    until the joint is at its edge, and grows again while the joint moves away.

    Args:
        name: The joint.
        lower: Lower limit of the joint [rad].
        upper: Upper limit of the joint [rad].
        shape: Widths, stiffness and damping of both walls.
    """

    def __init__(self, name: str, lower: float, upper: float, shape: WallShape) -> None:
        self._name = name
        self._lower = lower
        self._upper = upper
        self._shape = shape
        self._width = shape.spring_width + shape.damper_width
        self._scale = 1.0

    def begin(self, q: float) -> None:
        """Start at a position [rad].

        Raises:
            ControllerStateError: The position is beyond the limits.
        """
        if not self._lower <= q <= self._upper:
            raise ControllerStateError(
                f"Joint '{self._name}' is at {q:.4f} rad, beyond its soft limits "
                f"{self._lower:.4f} to {self._upper:.4f} rad.",
                remedy="Move the joint between its limits first.",
                details={"joint": self._name, "position": q},
            )
        self._scale = min(1.0, self._room(q) / self._width) if self._width else 1.0

    def torque(self, q: float, dq: float) -> float:
        """Return the wall's torque [Nm].

        Args:
            q: Position [rad].
            dq: Velocity [rad/s].
        """
        self._grow(q, dq)
        shape = self._shape
        spring = self._scale * shape.spring_width
        width = self._scale * self._width
        if q > self._upper - spring:
            return self._spring_torque(self._upper - spring - q, dq)
        if q < self._lower + spring:
            return self._spring_torque(self._lower + spring - q, dq)
        if q >= self._upper - width or q <= self._lower + width:
            return -shape.damping * dq
        return 0.0

    def _room(self, q: float) -> float:
        """Return the distance of a position to the nearer limit [rad]."""
        return min(abs(q - self._lower), abs(q - self._upper))

    def _grow(self, q: float, dq: float) -> None:
        if self._scale == 1.0:
            return
        room = self._room(q)
        if room >= self._width:
            self._scale = 1.0
        elif (dq > 0.0) == (q - self._lower < self._upper - q) and dq != 0.0:
            self._scale = max(self._scale, room / self._width)

    def _spring_torque(self, away: float, dq: float) -> float:
        return self._shape.stiffness * away - self._shape.spring_damping * dq


def wall_torques(
    walls: Sequence[JointWall], q: Sequence[float], dq: Sequence[float]
) -> list[float]:
    """Return the torques of the walls of several joints [Nm], shape (n,)."""
    return [
        wall.torque(position, velocity)
        for wall, position, velocity in zip(walls, q, dq, strict=True)
    ]
