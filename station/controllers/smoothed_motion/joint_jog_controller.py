"""Move joints at a velocity for as long as the set-point is repeated."""

from typing import ClassVar

from typing_extensions import override

from station.controllers.set_point_controller import CommandInterfaceT, JointQuantity
from station.controllers.smoothed_motion.smoothed_motion_controller import (
    SmoothedMotionController,
)
from station.core.description.robot_description import JointDescription
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
)

_LOOK_AHEAD = 0.02
"""Time for which joints that are far from their limits are not watched [s]."""


class JointJogController(SmoothedMotionController[CommandInterfaceT]):
    """Moves each joint at the velocity of the set-point, while a button is held.

    Every set-point is a heartbeat: when no set-point arrives within `command_timeout`,
    or the set-point is zero, the joints come to rest. A joint brakes early enough to
    stop at its position limits, and may move back from beyond them.
    """

    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY
    # For how long the joints need not be watched [s].
    _far_for: float

    @override
    def heading(self, set_point: list[float]) -> list[float]:
        return set_point

    @override
    def starting(self, time: float) -> None:
        self._far_for = 0.0
        super().starting(time)

    @override
    def wait(self) -> None:
        self._far_for = 0.0
        super().wait()

    @override
    def steer(self, set_point: list[float], period: float) -> None:
        self._far_for -= period
        if self._far_for > 0.0:
            self.generator.go_at(set_point)
            return
        moving = self.generator.velocities
        if not any(set_point) and not any(moving):
            self.generator.brake()
        elif self._is_far(_LOOK_AHEAD + period):
            self._far_for = _LOOK_AHEAD
            self.generator.go_at(set_point)
        else:
            self.generator.go_at(self._allowed(set_point, period))

    def _is_far(self, duration: float) -> bool:
        """Return whether no joint can come near its limits by any command.

        Args:
            duration: Time for which the command may act before the joint brakes [s].
        """
        limits, generator = self.limits, self.generator
        for joint, position, velocity, acceleration, jerk in zip(
            self.joints,
            generator.positions,
            generator.velocities,
            limits.acceleration,
            limits.jerk,
            strict=True,
        ):
            ramp = acceleration / jerk
            # The velocity still grows while an acceleration ends.
            speed = abs(velocity) + acceleration * (duration + 0.5 * ramp)
            braking = speed / acceleration + 2.0 * ramp
            way = speed * (duration + braking)
            if not joint.lower + way < position < joint.upper - way:
                return False
        return True

    def _allowed(self, set_point: list[float], period: float) -> list[float]:
        """Return the set-point without velocities that lead beyond a limit."""
        limits, ends = self.limits, self.generator.resting_positions()
        moving = self.generator.velocities
        allowed = []
        for index, wanted in enumerate(set_point):
            # The braking distance can grow by this much until the next cycle.
            growth = limits.acceleration[index] ** 2 / limits.jerk[index]
            margin = period * (3.0 * abs(moving[index]) + growth)
            allowed.append(_within(self.joints[index], wanted, ends[index], margin))
        return allowed


class PositionJointJogController(JointJogController[PositionJointInterface]):
    """Jogs joints by position commands."""


class EffortJointJogController(JointJogController[EffortJointInterface]):
    """Jogs joints by effort commands."""


def _within(
    joint: JointDescription, velocity: float, end: float, margin: float
) -> float:
    """Return the velocity, or 0 when it would lead beyond the limits of the joint.

    Args:
        joint: The joint.
        velocity: Desired velocity [rad/s or m/s].
        end: Position at which the joint would rest if it braked now [rad or m].
        margin: Distance before the limit at which to brake [rad or m].
    """
    if (velocity > 0.0 and end + margin >= joint.upper) or (
        velocity < 0.0 and end - margin <= joint.lower
    ):
        return 0.0
    return velocity
