"""Check that the joints can follow a motion of the end effector until it rests.

The arm keeps the position of joint 3 during a Cartesian motion. Near a position limit
of a joint and near singular poses the arm would abort the motion with an error. Every
step is therefore checked ahead, at the pose where the motion could rest after the step.
Jacobians and distances are computed again only when the joints have moved, not in every
cycle.
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

# Results for one configuration are used for configurations within this distance [rad].
_NEAR = 0.01
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
        # Bounds of the rows of `ArmConfiguration.joint_motion`.
        fastest = [joint.velocity * settings.joint_velocity_share for joint in joints]
        hardest = settings.max_joint_acceleration
        self._bounds = np.array([fastest, hardest, hardest, hardest])
        self.obstacle = Obstacle.NONE
        self.joint: str | None = None
        self._state = RobotState()
        self._elbow = 0.0
        nowhere = ArmConfiguration([0.0] * 7, [0.0] * 42)
        self._present = self._resting = nowhere
        self._rest, self._pose = [0.0] * 7, [0.0] * 16
        self._dexterity = 0.0
        self._clearance, self._clear_at = 0.0, [0.0] * 7

    def start(self, state: RobotState) -> None:
        """Start at rest at the desired joint positions.

        Args:
            state: The arm's state, which is updated in every cycle.
        """
        self._state = state
        self._elbow = state.q_d[ELBOW]
        self.obstacle, self.joint = Obstacle.NONE, None
        q = list(state.q_d)
        self._present = self._resting = self._configuration(q)
        self._rest, self._pose = q, self._pose_at(q)
        self._dexterity = self._resting.dexterity()
        self._clearance, self._clear_at = self._model.clearance(q), q

    def allows(self, motion: CartesianMotionGenerator) -> bool:
        """Return whether the joints can follow a step; note the obstacle if not.

        A step that increases the distance to an obstacle is allowed, so that the arm
        can leave a pose with too small a margin.

        Args:
            motion: The motion after the step.
        """
        resting = self._resting
        away = twist_between(self._pose, motion.resting_pose(), 1.0)
        step = resting.joint_step(away, self._elbow)
        q = [a + b for a, b in zip(resting.q, step, strict=True)]
        if max(map(abs, step)) > _NEAR:
            resting = self._configuration(q)
        self.joint = None
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
        """Return what keeps the arm from resting at joint positions.

        Args:
            q: Joint positions [rad], shape (7,).
            resting: A configuration near these positions.
        """
        self.joint = self._joint_at_limit(q)
        if self.joint is not None:
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

    def _joint_at_limit(self, q: list[float]) -> str | None:
        margin = self._settings.joint_limit_margin
        for joint, new, old in zip(self._joints, q, self._rest, strict=True):
            if (new < old and new < joint.lower + margin) or (
                new > old and new > joint.upper - margin
            ):
                return joint.name
        return None


def _distance(q: Sequence[float], other: Sequence[float]) -> float:
    return sum(abs(a - b) for a, b in zip(q, other, strict=True))
