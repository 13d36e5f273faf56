"""What joint positions make of the end effector, and its motion of the joints.

The six coordinates of the end effector and the position of joint 3, which stays, make
the motion of the seven joints unique.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

# Full accuracy, and no failure at a singular pose.
_DAMPING = 1e-9
_DOF = 7
ELBOW = 2
"""Index of the joint that stays."""
# Of the products dq_i dq_j in the acceleration of the end effector: its translation
# counts those of different joints twice, its rotation has none of one joint.
_OF_TRANSLATION = np.triu(np.full((_DOF, _DOF), 2.0)) - np.eye(_DOF)
_OF_ROTATION = np.triu(np.ones((_DOF, _DOF)), 1)


class ArmConfiguration:
    """One configuration of an arm with seven joints, and what holds around it.

    Args:
        q: Joint positions [rad], shape (7,).
        jacobian: Of the end effector in the axes of the base, 42 numbers, column-major.

    Attributes:
        q: As given.
    """

    def __init__(self, q: list[float], jacobian: Sequence[float]) -> None:
        self.q = q
        matrix = np.zeros((_DOF, _DOF))
        matrix[:6] = np.reshape(jacobian, (_DOF, 6)).T
        matrix[6, ELBOW] = 1.0
        self._matrix = matrix
        gram = matrix.T @ matrix
        gram.flat[:: _DOF + 1] += _DAMPING
        self._inverse = np.linalg.solve(gram, matrix.T)
        self._of_twist = self._inverse[:, :6].copy()
        self._drift = self._of_twist @ _drift_of(matrix)  # (7, 49)

    def dexterity(self) -> float:
        """Return the least singular value of the map from joints to end effector."""
        return float(np.linalg.svd(self._matrix, compute_uv=False)[-1])

    def joint_step(self, step: Sequence[float], elbow: float) -> list[float]:
        """Return the small motion of the joints that makes one of the end effector.

        Args:
            step: Shift [m], then turn [rad], in the axes of the base, shape (6,).
            elbow: Where joint 3 shall be [rad].

        Returns:
            Changes of the joint positions [rad], shape (7,).
        """
        right = np.array([*step, elbow - self.q[ELBOW]])
        result: list[float] = (self._inverse @ right).tolist()
        return result

    def joint_motion(
        self, twist: Sequence[float], accelerations: Sequence[Sequence[float]]
    ) -> NDArray[np.float64]:
        """Return the motion of the joints that belongs to one of the end effector.

        Args:
            twist: Of the end effector [m/s, rad/s], axes of the base, shape (6,).
            accelerations: Of the end effector [m/s^2, rad/s^2], same axes, shape
                (n, 6).

        Returns:
            Velocities [rad/s], then for each of the accelerations those of the joints
            [rad/s^2], then those without any; shape (n + 2, 7).
        """
        count = len(accelerations)
        result = np.zeros((count + 2, _DOF))
        given = np.array([twist, *accelerations])
        np.matmul(given, self._of_twist.T, out=result[: count + 1])
        dq = result[0]
        result[1:] -= self._drift @ np.multiply.outer(dq, dq).ravel()
        return result


def _drift_of(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what the products of joint velocities accelerate, shape (6, 49)."""
    result = np.empty((6, _DOF, _DOF))
    (a, b, c), z = matrix[3:6, :, None], matrix[3:6]
    for rows, (x, y, w), weight in (
        (slice(0, 3), matrix[:3], _OF_TRANSLATION),
        (slice(3, 6), z, _OF_ROTATION),
    ):
        part = result[rows]
        part[0] = b * w - c * y
        part[1] = c * x - a * w
        part[2] = a * y - b * x
        part *= weight
    return result.reshape(6, _DOF * _DOF)
