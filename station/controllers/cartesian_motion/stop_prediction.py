"""The joint motion of an end effector up to rest, ahead of time and linearised.

Where the joints would rest after a step follows from the pose at which the end effector
would rest, by the linearised kinematics of a configuration nearby.
"""

from collections.abc import Iterable

from station.controllers.cartesian_motion.linear_kinematics import (
    LinearKinematics,
    length_of,
    limited_joint,
    moved,
    way_between,
)
from station.controllers.cartesian_motion.pose_motion import PoseMotion
from station.core.numerics.rigid_motion import twist_between
from station.memory.doubles import Doubles, own, zeros
from station.memory.vectors import copy_into

# Results for one configuration are used for configurations within this distance [rad].
_NEAR = 0.01


class StopPrediction:
    """The rest positions of n joints after each step, and their distance to limits.

    Args:
        pose: Pose of the end effector at the configuration `resting`, 16 numbers; kept
            and not copied.
        new: Joint positions at rest after the new step [rad], shape (n,); kept and not
            copied.
        lower: Smallest joint positions [rad], shape (n,).
        upper: Largest joint positions [rad], shape (n,).
        velocity: Largest joint velocities [rad/s], shape (n,).
        acceleration: Largest joint accelerations [rad/s^2], shape (n,).

    Attributes:
        present: Kinematics at a configuration near the desired joint positions.
        resting: Kinematics at a configuration near the positions at rest.
    """

    def __init__(
        self,
        pose: Doubles,
        new: Doubles,
        *,
        lower: Iterable[float],
        upper: Iterable[float],
        velocity: Iterable[float],
        acceleration: Iterable[float],
    ) -> None:
        size = len(new)
        self.pose = pose
        self.new = new
        self.lower, self.upper = own(lower), own(upper)
        self.velocity, self.acceleration = own(velocity), own(acceleration)
        self.q_d = zeros(size)
        self.elbow = 0.0
        self.present = LinearKinematics(zeros(size), zeros(6 * size))
        self.resting = self.present
        # Positions at rest after the last allowed step, and those at which the arm was
        # clear, with the way that it may go from there.
        self.room = 0.0
        self.rest, self.clear = own([0.0] * size), own([0.0] * size)
        self.way, self.step = own([0.0] * 6), own([0.0] * size)
        self.size = size

    def start_at_rest(self, q_d: Doubles) -> None:
        """Start at rest.

        Args:
            q_d: Desired joint positions [rad], shape (n,), which are kept.
        """
        self.q_d = q_d
        self.elbow = q_d[2]
        copy_into(self.new, 0, q_d, self.size)
        self.accept()

    def passes(self, motion: PoseMotion) -> bool:
        """Return whether a step is certainly allowed; if so, accept it.

        Such a step is within all limits, near the configurations that are known. Any
        other step has to be examined.

        Args:
            motion: The motion of the end effector after the step.
        """
        if (
            motion.is_at_rest()
            or self.has_left()
            or self.leads_away(motion)
            or self.limited_joint() >= 0
            or self.may_collide()
            or not self.are_slow(motion)
            or not motion.stays_within_speed()
        ):
            return False
        self.accept()
        return True

    def has_left(self) -> bool:
        """Return whether the arm is no longer near the configuration `present`."""
        return way_between(self.q_d, self.present.q) > _NEAR

    def leads_away(self, motion: PoseMotion) -> bool:
        """Compute the positions at rest; return whether they are not near `resting`.

        Args:
            motion: The motion of the end effector after a step.
        """
        resting = self.resting
        motion.brake()
        twist_between(self.pose, motion.resting, 1.0, self.way)
        resting.joint_step(self.way, self.elbow, self.step)
        return moved(resting.q, self.step, self.new) > _NEAR

    def limited_joint(self) -> int:
        """Return the index of the first joint that would go beyond a limit, or -1."""
        return limited_joint(self.new, self.rest, self.lower, self.upper)

    def may_collide(self) -> bool:
        """Return whether the clearance at the positions at rest is unknown."""
        return way_between(self.new, self.clear) > self.room

    def are_slow(self, motion: PoseMotion) -> bool:
        """Return whether no joint exceeds its bounds, now and where the arm would rest.

        Args:
            motion: The motion of the end effector after a step.
        """
        present, resting = self.present, self.resting
        velocity, acceleration = self.velocity, self.acceleration
        push = length_of(motion.acceleration)
        braking = length_of(motion.peaks)
        if push < braking:
            push = braking
        return (
            present.are_slow(motion.twist, push, velocity, acceleration)
            or self.fastest_joint(present, motion) < 0
        ) and (
            resting.are_slow(motion.twist, push, velocity, acceleration)
            or self.fastest_joint(resting, motion) < 0
        )

    def fastest_joint(self, kinematics: LinearKinematics, motion: PoseMotion) -> int:
        """Return the index of the joint that exceeds its bounds most; -1 if none does.

        Args:
            kinematics: Kinematics at the configuration to look at.
            motion: The motion of the end effector after a step.
        """
        return kinematics.fastest_joint(
            motion.twist, motion.accelerations, self.velocity, self.acceleration
        )

    def accept(self) -> None:
        """Take the step: the joints can rest at the new positions."""
        copy_into(self.rest, 0, self.new, self.size)

    def note_clearance(self, room: float) -> None:
        """Note that no parts of the arm are near each other at the new positions.

        Args:
            room: How far the joints may go from there before that can change [rad];
                parts that are nearer to each other are looked at again at times.
        """
        self.room = room if room > _NEAR else _NEAR
        copy_into(self.clear, 0, self.new, self.size)
