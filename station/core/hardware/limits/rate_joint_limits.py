"""Limit position and velocity commands against the command of the last cycle.

These handles can be used instead of the saturation and soft limit handles. They limit
acceleration and jerk, too, and a joint outside its range is not pulled back, but may
only move towards the range. Effort commands have no rate to limit;
`EffortJointSaturationHandle` serves them in this mode. Outside the range it admits only
an effort that points back.

The limits act against the velocity and acceleration of the last cycle. They are applied
in this order, so that the later ones win:

1. jerk: the acceleration changes by at most `j_max * period`;
2. acceleration: at most `a_max`, and less towards `v_max` so that jerk can hold there;
3. velocity: at most `v_max`;
4. range: the joint can still stop at the bound with `a_max`; outside its range it may
   only move back towards it.

`approach` gives the largest rate from which a value stops within a distance D when the
rate may fall by `r * period` in each cycle: `r * (sqrt(2*D/r) - period/2)`. One cycle
later, the rate minus `r * period` is again within the value of `approach`. Therefore
range and acceleration never contradict each other, nor do velocity and jerk. With both
acceleration and jerk limits, braking begins earlier, by the distance that the rise of
the deceleration takes. The range then seldom requires more jerk than allowed; if it
does, the range wins.
"""

from math import inf
from typing import ClassVar

from station.core.hardware.limits.joint_limits_handle import JointLimitsHandle
from station.core.hardware.limits.joint_limits_interface import JointLimitsInterface
from station.core.hardware.limits.limited_joints import LimitedJoints
from station.core.hardware.limits.rate_limits import (
    PositionRateLimits,
    VelocityRateLimits,
)


class PositionJointRateLimitsHandle(JointLimitsHandle):
    """Limit the velocity, acceleration and jerk of position commands, and their range.

    The first command after construction or `reset` starts from the measured position
    and velocity. A period of 0 or less repeats the last command. Position commands are
    in [rad or m]. All limits are optional.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = PositionRateLimits
    unlimited: ClassVar[float] = inf


class VelocityJointRateLimitsHandle(JointLimitsHandle):
    """Limit the acceleration and jerk of velocity commands, and the joint's range.

    The range is that of the measured position. The first command after construction
    or `reset` starts from the measured velocity. A period of 0 or less repeats the last
    command. Velocity commands are in [rad/s or m/s]. All limits are optional.
    """

    arithmetic: ClassVar[type[LimitedJoints]] = VelocityRateLimits
    unlimited: ClassVar[float] = inf


class PositionJointRateLimitsInterface(
    JointLimitsInterface[PositionJointRateLimitsHandle]
):
    """Limits of position-controlled joints against the command of the last cycle."""


class VelocityJointRateLimitsInterface(
    JointLimitsInterface[VelocityJointRateLimitsHandle]
):
    """Limits of velocity-controlled joints against the command of the last cycle."""
