"""Whether the joints can follow a motion of the end effector to its end.

The arm completes a Cartesian motion with the position of joint 3, which stays. Near a
position limit of a joint and near singular poses the arm would end the motion with an
error; so every step is first followed to where it could rest. Jacobians and distances
are worked out anew when the joints have moved, not in every cycle.
"""

from collections.abc import Sequence
from enum import Enum

import numpy as np

from station.controllers.cartesian_motion.arm_configuration import (
    ELBOW,
    ArmConfiguration,
)
from station.controllers.cartesian_motion.cartesian_motion_generator import (
    CartesianMotionGenerator,
)
from station.controllers.cartesian_motion.lookahead_settings import LookaheadSettings
from station.core.description.robot_description import JointDescription
from station.core.franka import Frame, FrankaModelHandle
from station.core.franka.franka_robot_state import RobotState
from station.core.numerics.rigid_motion import twist_between

# What was worked out for a configuration holds for one as near as that [rad].
_NEAR = 0.01
# No part of the arm is farther from the axis that turns it than that [m].
_REACH = 1.2


class Obstacle(Enum):
    """What keeps the end effector from going on."""

    NONE = "none"
    JOINT_LIMIT = "joint_limit"
    SINGULARITY = "singularity"
    SELF_COLLISION = "self_collision"
    JOINT_SPEED = "joint_speed"


class JointLookahead:
    """Follows the joints to where the end effector would rest. Control thread only.

    Args:
        model: The arm's model.
        joints: Its joints, from the base on, with their limits; 7.
        settings: How much is kept free.

    Attributes:
        obstacle: What was in the way of the step looked at last.
        joint: Name of the joint that is at its limit; empty when none is.
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
        # Rows of the motion of the joints, over what is allowed: at most 1.
        fastest = [joint.velocity * settings.joint_velocity_share for joint in joints]
        hardest = settings.max_joint_acceleration
        self._bounds = np.array([fastest, hardest, hardest, hardest])
        self.obstacle = Obstacle.NONE
        self.joint = ""
        self._state = RobotState()
        self._elbow = 0.0
        nowhere = ArmConfiguration([0.0] * 7, [0.0] * 42)
        self._present = self._resting = nowhere
        self._rest, self._pose = [0.0] * 7, [0.0] * 16
        self._dexterity = 0.0
        self._clearance, self._clear_at = 0.0, [0.0] * 7

    def start(self, state: RobotState) -> None:
        """Begin where the arm is meant to be, at rest.

        Args:
            state: The arm's live state.
        """
        self._state = state
        self._elbow = state.q_d[ELBOW]
        self.obstacle, self.joint = Obstacle.NONE, ""
        q = list(state.q_d)
        self._present = self._resting = self._configuration(q)
        self._rest, self._pose = q, self._pose_at(q)
        self._dexterity = self._resting.dexterity()
        self._clearance, self._clear_at = self._model.clearance(q), q

    def allows(self, motion: CartesianMotionGenerator) -> bool:
        """Say whether the joints can do a step; note what is in the way if not.

        A step that leads out of where the arm should not be is allowed.

        Args:
            motion: The motion after the step.
        """
        resting = self._resting
        away = twist_between(self._pose, motion.resting_pose(), 1.0)
        step = resting.joint_step(away, self._elbow)
        q = [a + b for a, b in zip(resting.q, step, strict=True)]
        if max(map(abs, step)) > _NEAR:
            resting = self._configuration(q)
        self.joint = ""
        self.obstacle = self._obstacle_at(q, resting)
        if self.obstacle is Obstacle.NONE:
            self.obstacle = self._speed_obstacle(resting, motion)
        if self.obstacle is not Obstacle.NONE:
            return False
        if resting is not self._resting:
            self._resting, self._pose = resting, self._pose_at(q)
        self._rest = q
        return True

    def _obstacle_at(self, q: list[float], resting: ArmConfiguration) -> Obstacle:
        """Return what keeps the arm from resting somewhere.

        Args:
            q: Where [rad], shape (7,).
            resting: A configuration near it.
        """
        self.joint = self._joint_at_limit(q)
        if self.joint:
            return Obstacle.JOINT_LIMIT
        dexterity = self._dexterity
        if resting is not self._resting:
            dexterity = resting.dexterity()
            if dexterity < min(self._settings.least_dexterity, self._dexterity):
                return Obstacle.SINGULARITY
        least = self._settings.least_clearance
        room = max(_NEAR, (self._clearance - least) / _REACH)
        if _distance(q, self._clear_at) > room:
            clearance = self._model.clearance(q)
            if clearance < min(least, self._clearance):
                return Obstacle.SELF_COLLISION
            self._clearance, self._clear_at = clearance, q
        self._dexterity = dexterity
        return Obstacle.NONE

    def _speed_obstacle(
        self, resting: ArmConfiguration, motion: CartesianMotionGenerator
    ) -> Obstacle:
        q = self._state.q_d
        if _distance(q, self._present.q) > _NEAR:
            self._present = self._configuration(list(q))
        needed = (motion.acceleration, motion.braking())
        for configuration in (self._present, resting):
            wanted = configuration.joint_motion(motion.twist, needed)
            excess = np.abs(wanted) / self._bounds
            if excess.max() > 1.0:
                self.joint = self._joints[int(excess.argmax()) % len(q)].name
                return Obstacle.JOINT_SPEED
        return Obstacle.NONE

    def _configuration(self, q: list[float]) -> ArmConfiguration:
        state, model, frame = self._state, self._model, Frame.END_EFFECTOR
        jacobian = model.zero_jacobian(frame, q, state.F_T_EE, state.EE_T_K)
        return ArmConfiguration(q, jacobian)

    def _pose_at(self, q: list[float]) -> list[float]:
        state, frame = self._state, Frame.END_EFFECTOR
        return self._model.pose(frame, q, state.F_T_EE, state.EE_T_K)

    def _joint_at_limit(self, q: list[float]) -> str:
        margin = self._settings.joint_limit_margin
        for joint, new, old in zip(self._joints, q, self._rest, strict=True):
            if (new < old and new < joint.lower + margin) or (
                new > old and new > joint.upper - margin
            ):
                return joint.name
        return ""


def _distance(q: Sequence[float], other: Sequence[float]) -> float:
    return sum(abs(a - b) for a, b in zip(q, other, strict=True))
