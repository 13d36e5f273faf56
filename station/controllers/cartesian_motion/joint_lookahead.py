"""Whether the joints can follow a motion of the end effector to its end.

The arm completes a Cartesian motion with the position of joint 3, which stays. Near a
position limit of a joint and near singular poses the arm would end the motion with an
error; so every step is first followed to where it could rest.
"""

from enum import Enum

import numpy as np
from numpy.typing import NDArray

from station.controllers.cartesian_motion.arm_configuration import (
    ELBOW,
    ArmConfiguration,
)
from station.controllers.cartesian_motion.cartesian_motion_generator import (
    CartesianMotionGenerator,
)
from station.controllers.cartesian_motion.lookahead_settings import LookaheadSettings
from station.core.interfaces import Frame, FrankaModelHandle
from station.core.interfaces.franka_robot_state import RobotState
from station.core.rigid_motion import twist_between
from station.core.robot_description import JointDescription


class Obstacle(Enum):
    """What keeps the end effector from going on."""

    NONE = "none"
    JOINT_LIMIT = "joint_limit"
    SINGULARITY = "singularity"
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
        self._fastest = np.array([
            joint.velocity * settings.joint_velocity_share for joint in joints
        ])
        self._hardest = np.array(settings.max_joint_acceleration)
        self.obstacle = Obstacle.NONE
        self.joint = ""
        self._state = RobotState()
        self._elbow = 0.0
        self._pose = [0.0] * 16
        self._resting = ArmConfiguration([0.0] * 7, [0.0] * 42)
        self._dexterity = 0.0

    def start(self, state: RobotState) -> None:
        """Begin where the arm is meant to be, at rest.

        Args:
            state: The arm's live state.
        """
        self._state = state
        self._elbow = state.q_d[ELBOW]
        self.obstacle, self.joint = Obstacle.NONE, ""
        self._resting = self._configuration(list(state.q_d))
        self._pose = self._pose_at(self._resting.q)
        self._dexterity = self._resting.dexterity()

    def allows(self, motion: CartesianMotionGenerator) -> bool:
        """Say whether the joints can do a step; note what is in the way if not.

        A step that leads out of where the arm should not be is allowed.

        Args:
            motion: The motion after the step.
        """
        away = twist_between(self._pose, motion.resting_pose(), 1.0)
        step = self._resting.joint_step(away, self._elbow)
        q = [a + b for a, b in zip(self._resting.q, step, strict=True)]
        resting = self._configuration(q)
        dexterity = resting.dexterity()
        self.obstacle = Obstacle.NONE
        self.joint = self._joint_at_limit(q)
        if self.joint:
            self.obstacle = Obstacle.JOINT_LIMIT
        elif dexterity < min(self._settings.least_dexterity, self._dexterity):
            self.obstacle = Obstacle.SINGULARITY
        else:
            present = self._configuration(self._state.q_d)
            self.joint = self._too_fast(present, motion) or self._too_fast(
                resting, motion
            )
            if self.joint:
                self.obstacle = Obstacle.JOINT_SPEED
        if self.obstacle is not Obstacle.NONE:
            return False
        self._resting, self._dexterity = resting, dexterity
        self._pose = self._pose_at(q)
        return True

    def _configuration(self, q: list[float]) -> ArmConfiguration:
        state = self._state
        jacobian = self._model.zero_jacobian(
            Frame.END_EFFECTOR, q, state.F_T_EE, state.EE_T_K
        )
        return ArmConfiguration(q, jacobian)

    def _pose_at(self, q: list[float]) -> list[float]:
        state = self._state
        return self._model.pose(Frame.END_EFFECTOR, q, state.F_T_EE, state.EE_T_K)

    def _joint_at_limit(self, q: list[float]) -> str:
        margin = self._settings.joint_limit_margin
        for joint, new, old in zip(self._joints, q, self._resting.q, strict=True):
            if (new < old and new < joint.lower + margin) or (
                new > old and new > joint.upper - margin
            ):
                return joint.name
        return ""

    def _too_fast(
        self, configuration: ArmConfiguration, motion: CartesianMotionGenerator
    ) -> str:
        """Return a joint for which the motion and its end are too fast, or ''."""
        dq = configuration.joint_velocities(motion.twist)
        over = self._over(dq, self._fastest)
        if over:
            return over
        braking = motion.braking()
        needed = np.array([motion.acceleration, braking, [0.0] * 6]).T
        ddq = np.abs(configuration.joint_accelerations(dq, needed)).max(axis=1)
        return self._over(ddq, self._hardest)

    def _over(self, values: NDArray[np.float64], bounds: NDArray[np.float64]) -> str:
        excess = np.abs(values) / bounds
        worst = int(excess.argmax())
        return self._joints[worst].name if excess[worst] > 1.0 else ""
