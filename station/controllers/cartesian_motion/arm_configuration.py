"""Inverse kinematics of an arm with seven joints around one configuration.

Six coordinates of the end effector do not determine the motion of seven joints. The
arm therefore keeps the position of joint 3, which makes the motion unique.
"""

from collections.abc import Sequence

import numpy as np

from station.kernel import linear_kinematics
from station.kernel.doubles import doubles

_DOF = 7
ELBOW = 2
"""Index of joint 3, whose position is kept."""


class ArmConfiguration:
    """The linearised kinematics at one configuration of an arm with seven joints.

    Args:
        q: Joint positions [rad], shape (7,).
        jacobian: Jacobian of the end effector in the axes of the base, 42 numbers,
            column-major.

    Attributes:
        q: Joint positions [rad], shape (7,).
        motion: Motions of the joints that belong to motions of the end effector.
    """

    def __init__(self, q: Sequence[float], jacobian: Sequence[float]) -> None:
        self.q = doubles(q)
        self._jacobian = doubles(jacobian)
        self.motion = linear_kinematics.LinearKinematics(self.q, self._jacobian)
        self.motion.invert()

    def dexterity(self) -> float:
        """Return the smallest singular value of the extended Jacobian.

        The extended Jacobian maps joint velocities to the twist of the end effector and
        the velocity of joint 3. The value is 0 at a singular pose.
        """
        matrix = np.zeros((_DOF, _DOF))
        matrix[:6] = np.reshape(self._jacobian, (_DOF, 6)).T
        matrix[6, ELBOW] = 1.0
        return float(np.linalg.svd(matrix, compute_uv=False)[-1])
