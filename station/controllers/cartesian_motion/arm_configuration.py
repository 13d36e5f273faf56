"""Inverse kinematics of an arm with seven joints around one configuration.

Six coordinates of the end effector do not determine the motion of seven joints. The
arm therefore keeps the position of joint 3, which makes the motion unique.
"""

import numpy as np

from station.controllers.cartesian_motion.linear_kinematics import LinearKinematics
from station.core.franka import Frame
from station.core.franka.franka_model import FrankaModel
from station.core.franka.franka_robot_state import RobotState
from station.memory.doubles import Doubles, own

_DOF = 7
ELBOW = 2
"""Index of joint 3, whose position is kept."""


class ArmConfiguration:
    """The linearised kinematics at one configuration of an arm with seven joints.

    Args:
        model: The arm's model.
        state: Its state, which tells what the end effector is.

    Attributes:
        motion: Motions of the joints that belong to motions of the end effector.
    """

    def __init__(self, model: FrankaModel, state: RobotState) -> None:
        self._q, self._jacobian = own([0.0] * _DOF), own([0.0] * (6 * _DOF))
        frame = Frame.END_EFFECTOR
        tool = state.doubles("F_T_EE"), state.doubles("EE_T_K")
        self._pose_source = model.pose_source(frame, self._q, *tool)
        self._jacobian_source = model.zero_jacobian_source(frame, self._q, *tool)
        self.motion = LinearKinematics(self._q, self._jacobian)

    def move_to(self, q: Doubles) -> None:
        """Take another configuration.

        Args:
            q: Joint positions [rad], shape (7,).
        """
        self._q[:] = q
        self._jacobian_source.write(self._jacobian)
        self.motion.invert()

    def place(self, pose: Doubles) -> None:
        """Write the pose of the end effector, 16 numbers."""
        self._pose_source.write(pose)

    def dexterity(self) -> float:
        """Return the smallest singular value of the extended Jacobian.

        The extended Jacobian maps joint velocities to the twist of the end effector and
        the velocity of joint 3. The value is 0 at a singular pose.
        """
        matrix = np.zeros((_DOF, _DOF))
        matrix[:6] = np.reshape(self._jacobian, (_DOF, 6)).T
        matrix[6, ELBOW] = 1.0
        return float(np.linalg.svd(matrix, compute_uv=False)[-1])
