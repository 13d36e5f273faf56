"""Check that the joints can follow a motion of the end effector until it rests.

The arm keeps the position of joint 3 during a Cartesian motion. Near a position limit
of a joint and near singular poses the arm would abort the motion with an error. Every
step is therefore checked ahead, at the pose where the motion could rest after the step.
Jacobians and distances are computed again only when the joints have moved, not in every
cycle.
"""

from enum import Enum

from station.controllers.cartesian_motion.arm_configuration import ArmConfiguration
from station.controllers.cartesian_motion.cartesian_motion_generator import (
    CartesianMotionGenerator,
)
from station.controllers.cartesian_motion.joint_preview import JointPreview
from station.controllers.cartesian_motion.linear_kinematics import LinearKinematics
from station.controllers.cartesian_motion.lookahead_settings import LookaheadSettings
from station.controllers.cartesian_motion.pose_motion import PoseMotion
from station.core.description.robot_description import JointDescription
from station.core.franka import FrankaModelHandle
from station.core.franka.franka_robot_state import RobotState
from station.memory.doubles import zeros

# Largest distance of a part of the arm from a joint axis that moves it [m].
_REACH = 1.2


class Obstacle(Enum):
    """The reason why the end effector waits or slows down."""

    NONE = "none"
    JOINT_LIMIT = "joint_limit"
    SINGULARITY = "singularity"
    SELF_COLLISION = "self_collision"
    JOINT_SPEED = "joint_speed"


class JointLookahead:
    """Computes the joint motion up to rest ahead of time. Control thread only.

    Args:
        model: The arm's model.
        joints: The arm's seven joints with their limits, from base to flange.
        settings: Margins that the motion keeps.

    Attributes:
        obstacle: What prevents the step that was checked last.
        joint: Name of the joint that is at its limit; None when no joint is.
    """

    def __init__(
        self,
        model: FrankaModelHandle,
        joints: list[JointDescription],
        settings: LookaheadSettings,
    ) -> None:
        self._model = model.model
        self._joints = joints
        self._settings = settings
        margin, share = settings.joint_limit_margin, settings.joint_velocity_share
        # Pose of the end effector at the configuration at rest, and joint positions at
        # rest after a new step.
        self._pose, self._new = zeros(16), zeros(7)
        self._preview = JointPreview(
            self._pose,
            self._new,
            lower=[joint.lower + margin for joint in joints],
            upper=[joint.upper - margin for joint in joints],
            velocity=[joint.velocity * share for joint in joints],
            acceleration=settings.max_joint_acceleration,
        )
        self.obstacle = Obstacle.NONE
        self.joint: str | None = None
        # One near the desired positions, one near those at rest, and one for the next.
        self._present: ArmConfiguration
        self._resting: ArmConfiguration
        self._other: ArmConfiguration
        self._know(RobotState())
        self._dexterity, self._clearance = 0.0, 0.0

    def start(self, state: RobotState) -> None:
        """Start at rest at the desired joint positions.

        Args:
            state: The arm's state, which is updated in every cycle.
        """
        self._know(state)
        self.obstacle, self.joint = Obstacle.NONE, None
        self._preview.begin(self._q_d)
        for each in (self._present, self._resting):
            each.move_to(self._q_d)
        self._resting.place(self._pose)
        self._dexterity = self._resting.dexterity()
        self._note_clearance(self._model.clearance(self._q_d))

    def passes(self, motion: CartesianMotionGenerator) -> bool:
        """Allow a usual step in one call; return whether it was allowed.

        Of a step that comes near a limit or leads away from the known configurations
        nothing is decided: `allows` has to look at it.

        Args:
            motion: The motion after the step.
        """
        if not self._preview.passes(motion.motion):
            return False
        self.obstacle, self.joint = Obstacle.NONE, None
        return True

    def allows(self, motion: CartesianMotionGenerator) -> bool:
        """Return whether the joints can follow a step; note the obstacle if not.

        A step that increases the distance to an obstacle is allowed, so that the arm
        can leave a pose with too small a margin.

        Args:
            motion: The motion after the step.
        """
        resting = self._resting
        if self._preview.leads_away(motion.motion):
            resting = self._other
            resting.move_to(self._new)
        self.joint = None
        self.obstacle = self._obstacle_at(resting)
        if self.obstacle is Obstacle.NONE:
            self.obstacle = self._speed_obstacle(resting.motion, motion.motion)
        if self.obstacle is not Obstacle.NONE:
            return False
        if resting is not self._resting:
            self._resting, self._other = resting, self._resting
            self._preview.resting = resting.motion
            resting.place(self._pose)
        self._preview.accept()
        return True

    def _obstacle_at(self, resting: ArmConfiguration) -> Obstacle:
        """Return what keeps the arm from resting at the new joint positions.

        Args:
            resting: A configuration near these positions.
        """
        limited = self._preview.limited_joint()
        if limited >= 0:
            self.joint = self._joints[limited].name
            return Obstacle.JOINT_LIMIT
        dexterity = self._dexterity
        if resting is not self._resting:
            dexterity = least = self._settings.least_dexterity
            # Singular values take long to compute, so only where they matter.
            if not resting.motion.is_dexterous(least):
                dexterity = resting.dexterity()
                if dexterity < min(least, self._dexterity):
                    return Obstacle.SINGULARITY
        if self._preview.may_collide():
            clearance = self._model.clearance(self._new)
            if clearance < min(self._settings.least_clearance, self._clearance):
                return Obstacle.SELF_COLLISION
            self._note_clearance(clearance)
        self._dexterity = dexterity
        return Obstacle.NONE

    def _speed_obstacle(
        self, resting: LinearKinematics, motion: PoseMotion
    ) -> Obstacle:
        preview = self._preview
        if preview.has_left():
            self._present.move_to(self._q_d)
        for kinematics in (self._present.motion, resting):
            fastest = preview.fastest_joint(kinematics, motion)
            if fastest >= 0:
                self.joint = self._joints[fastest].name
                return Obstacle.JOINT_SPEED
        return Obstacle.NONE

    def _note_clearance(self, clearance: float) -> None:
        """Note the least distance of parts of the arm [m] at the new positions."""
        self._clearance = clearance
        # No part of the arm moves further than its distance from a joint times the way
        # of that joint.
        self._preview.note_clearance(
            (clearance - self._settings.least_clearance) / _REACH
        )

    def _know(self, state: RobotState) -> None:
        """Make room for configurations of an arm with this state."""
        self._q_d = state.doubles("q_d")
        self._present, self._resting, self._other = (
            ArmConfiguration(self._model, state) for _ in range(3)
        )
        self._preview.present = self._present.motion
        self._preview.resting = self._resting.motion
