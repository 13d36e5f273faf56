"""Whether the joints can follow a motion of the end effector to its end.

The arm completes a Cartesian motion with the position of joint 3, which stays. Near a
position limit of a joint and near singular poses the arm would end the motion with an
error; so every step is first followed to where it could rest.
"""

from enum import Enum

import numpy as np
from numpy.typing import NDArray

from station.controllers.cartesian_motion.lookahead_settings import LookaheadSettings
from station.core.interfaces import Frame, FrankaModelHandle
from station.core.interfaces.franka_robot_state import RobotState
from station.core.rigid_motion import twist_between
from station.core.robot_description import JointDescription

# Of the Newton step: full accuracy, and no failure at a singular pose.
_DAMPING = 1e-9
_ELBOW = 2


class Obstacle(Enum):
    """What keeps the end effector from going on."""

    NONE = "none"
    JOINT_LIMIT = "joint_limit"
    SINGULARITY = "singularity"
    JOINT_VELOCITY = "joint_velocity"


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
        self._model = model
        self._joints = joints
        self._settings = settings
        self.obstacle = Obstacle.NONE
        self.joint = ""
        self._state = RobotState()
        self._elbow = 0.0
        self._q = [0.0] * 7
        self._pose = [0.0] * 16
        self._matrix = np.eye(7)
        self._dexterity = 0.0

    def start(self, state: RobotState) -> None:
        """Begin where the arm is meant to be, at rest.

        Args:
            state: The arm's live state.
        """
        self._state = state
        self._elbow = state.q_d[_ELBOW]
        self.obstacle, self.joint = Obstacle.NONE, ""
        self._accept(list(state.q_d), *self._kinematics(state.q_d))

    def allows(self, resting_pose: list[float], twist: list[float]) -> bool:
        """Say whether the joints can do a step; note what is in the way if not.

        A step that leads out of where the arm should not be is allowed.

        Args:
            resting_pose: Where the end effector rests when it brakes after the step.
            twist: Its velocity after the step [m/s, rad/s], axes of the base.
        """
        away = twist_between(self._pose, resting_pose, 1.0)
        step = _solve(self._matrix, [*away, self._elbow - self._q[_ELBOW]])
        q = [a + b for a, b in zip(self._q, step, strict=True)]
        pose, matrix, dexterity = self._kinematics(q)
        self.joint = self._joint_at_limit(q)
        self.obstacle = Obstacle.NONE
        if self.joint:
            self.obstacle = Obstacle.JOINT_LIMIT
        elif dexterity < min(self._settings.least_dexterity, self._dexterity):
            self.obstacle = Obstacle.SINGULARITY
        else:
            self.joint = self._joint_too_fast(_solve(matrix, [*twist, 0.0]))
            if self.joint:
                self.obstacle = Obstacle.JOINT_VELOCITY
        if self.obstacle is not Obstacle.NONE:
            return False
        self._accept(q, pose, matrix, dexterity)
        return True

    def _accept(
        self,
        q: list[float],
        pose: list[float],
        matrix: NDArray[np.float64],
        dexterity: float,
    ) -> None:
        self._q, self._pose = q, pose
        self._matrix, self._dexterity = matrix, dexterity

    def _kinematics(
        self, q: list[float]
    ) -> tuple[list[float], NDArray[np.float64], float]:
        """Return pose, Jacobian with the elbow as last row, least singular value."""
        state, model = self._state, self._model.model
        tool = (state.F_T_EE, state.EE_T_K)
        pose = model.pose(Frame.END_EFFECTOR, q, *tool)
        jacobian = model.zero_jacobian(Frame.END_EFFECTOR, q, *tool)
        matrix = np.zeros((7, 7))
        matrix[:6] = np.reshape(jacobian, (7, 6)).T
        matrix[6, _ELBOW] = 1.0
        return pose, matrix, float(np.linalg.svd(matrix, compute_uv=False)[-1])

    def _joint_at_limit(self, q: list[float]) -> str:
        margin = self._settings.joint_limit_margin
        for joint, new, old in zip(self._joints, q, self._q, strict=True):
            if (new < old and new < joint.lower + margin) or (
                new > old and new > joint.upper - margin
            ):
                return joint.name
        return ""

    def _joint_too_fast(self, dq: list[float]) -> str:
        share = self._settings.joint_velocity_share
        for joint, rate in zip(self._joints, dq, strict=True):
            if abs(rate) > share * joint.velocity:
                return joint.name
        return ""


def _solve(matrix: NDArray[np.float64], right: list[float]) -> list[float]:
    """Return the least-squares solution with Tikhonov damping, shape (7,)."""
    gram = matrix.T @ matrix + _DAMPING * np.eye(7)
    result: list[float] = np.linalg.solve(gram, matrix.T @ np.array(right)).tolist()
    return result
