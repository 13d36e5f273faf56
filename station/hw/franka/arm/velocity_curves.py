"""Velocity limits that decrease towards the ends of a joint's range.

A joint that keeps these limits comes to rest at the end, with a deceleration of at most
b / 2, half of the slope b of the squared velocity.

Source: libfranka@0.20.4 src/joint_velocity_limits.cpp,
JointVelocityLimitsConfig::getUpperJointVelocityLimits, getLowerJointVelocityLimits.
"""

from collections.abc import Sequence

from station.memory.doubles import Storage, own
from station.memory.functions import square_root


def velocity_towards_end(highest: float, a: float, b: float, room: float) -> float:
    """Return the highest velocity of a joint towards an end of its range [rad/s].

    Args:
        highest: The limit far from the end [rad/s], >= 0.
        a: Number subtracted from the velocity [rad/s], >= 0.
        b: Slope of the squared velocity over the distance [rad/s^2], >= 0.
        room: Distance from the end [rad].
    """
    # Beyond the end the root has no real value: the joint may only come back. A joint
    # whose position is NaN must not move.
    velocity = square_root(b * room) - a if room > 0.0 else 0.0
    if velocity > highest:
        return highest
    return velocity if velocity > 0.0 else 0.0


class VelocityCurves:
    """Velocity limits of n joints, which depend on their positions.

    Args:
        highest: The limits in the middle of the ranges [rad/s], shape (n,).
        curves: (a, b, upper end, lower end) of each joint.
        margins: How far inside the limits each joint's range of velocities ends
            [rad/s], shape (n,); negative for outside. No range has negative width.
    """

    def __init__(
        self,
        highest: Sequence[float],
        curves: Sequence[Sequence[float]],
        margins: Sequence[float],
    ) -> None:
        columns = [*zip(*curves, strict=True)] or [()] * 4
        self.size = len(curves)
        self.highest, self.margins = own(highest), own(margins)
        self.a, self.b, self.upper, self.lower = map(own, columns)

    def put(self, q: Storage, lowest: Storage, highest: Storage) -> None:
        """Write the lowest and the highest velocities at some positions.

        Args:
            q: Positions of the joints [rad], shape (n,).
            lowest: Receives the limits of negative velocities [rad/s], shape (n,).
            highest: Receives the limits of positive velocities [rad/s], shape (n,).
        """
        for i in range(self.size):
            most, a, b = self.highest[i], self.a[i], self.b[i]
            margin = self.margins[i]
            fastest = velocity_towards_end(most, a, b, self.upper[i] - q[i])
            fastest -= margin
            highest[i] = fastest if fastest > 0.0 else 0.0
            fastest = velocity_towards_end(most, a, b, q[i] - self.lower[i])
            fastest -= margin
            # A difference, so that no limit is -0.
            lowest[i] = 0.0 - (fastest if fastest > 0.0 else 0.0)
