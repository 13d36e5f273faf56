"""Move joints while somebody holds a button."""

from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
)
from station.controllers.smoothed_motion.smoothed_motion_controller import (
    SmoothedMotionController,
)
from station.core.description.robot_description import JointDescription


class JointJogControllerBase(SmoothedMotionController[CommandInterfaceT]):
    """Moves each joint at the velocity of the set-point, for as long as it is repeated.

    Every set-point is a heartbeat: when the next one stays out for `command_timeout`,
    or is zero, the joints come to rest. A joint brakes in time before its position
    limits, and goes back from beyond them.
    """

    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY

    @override
    def heading(self, set_point: list[float]) -> list[float]:
        return set_point

    @override
    def steer(self, set_point: list[float], period: float) -> None:
        if not any(set_point) and not any(self.generator.velocities):
            self.generator.brake()
            return
        limits, moving = self.limits, self.generator.velocities
        ends = self.generator.resting_positions()
        allowed = []
        for index, wanted in enumerate(set_point):
            # How much longer the way to rest can become until the next look.
            growth = limits.acceleration[index] ** 2 / limits.jerk[index]
            margin = period * (3.0 * abs(moving[index]) + growth)
            allowed.append(_within(self.joints[index], wanted, ends[index], margin))
        self.generator.go_at(allowed)


def _within(
    joint: JointDescription, velocity: float, end: float, margin: float
) -> float:
    """Return the velocity, or 0 when it would lead beyond the joint's limits.

    Args:
        joint: The joint.
        velocity: Wanted [rad/s or m/s].
        end: Where it would rest if it braked now [rad or m].
        margin: How far before the limit to brake [rad or m].
    """
    if (velocity > 0.0 and end + margin >= joint.upper) or (
        velocity < 0.0 and end - margin <= joint.lower
    ):
        return 0.0
    return velocity
