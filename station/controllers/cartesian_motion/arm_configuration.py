"""Inverse kinematics of an arm with seven joints around one configuration.

Six coordinates of the end effector do not determine the motion of seven joints. The
arm therefore keeps the position of joint 3, which makes the motion unique.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

# Small enough for full accuracy; keeps the matrix invertible at a singular pose.
_DAMPING = 1e-9
_DOF = 7
ELBOW = 2
"""Index of joint 3, whose position is kept."""
# Weights of the products dq_i dq_j, i <= j, in the acceleration of the end effector.
# In the translation, products of different joints occur twice; in the rotation,
# products of a joint with itself do not occur.
_OF_TRANSLATION = np.triu(np.full((_DOF, _DOF), 2.0)) - np.eye(_DOF)
_OF_ROTATION = np.triu(np.ones((_DOF, _DOF)), 1)


class ArmConfiguration:
    """The linearised kinematics at one configuration of an arm with seven joints.

    Args:
        q: Joint positions [rad], shape (7,).
        jacobian: Jacobian of the end effector in the axes of the base, 42 numbers,
            column-major.

    Attributes:
        q: Joint positions [rad], shape (7,).
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
        """Return the smallest singular value of the extended Jacobian.

        The extended Jacobian maps joint velocities to the twist of the end effector and
        the velocity of joint 3. The value is 0 at a singular pose.
        """
        return float(np.linalg.svd(self._matrix, compute_uv=False)[-1])

    def joint_step(self, step: Sequence[float], elbow: float) -> list[float]:
        """Return the joint motion that displaces the end effector by a small step.

        Args:
            step: Translation [m], then rotation vector [rad], in the axes of the base,
                shape (6,).
            elbow: Desired position of joint 3 [rad].

        Returns:
            Changes of the joint positions [rad], shape (7,).
        """
        right = np.array([*step, elbow - self.q[ELBOW]])
        result: list[float] = (self._inverse @ right).tolist()
        return result

    def joint_motion(
        self, twist: Sequence[float], accelerations: Sequence[Sequence[float]]
    ) -> NDArray[np.float64]:
        """Return velocities and accelerations of the joints for end effector motions.

        Args:
            twist: Twist of the end effector [m/s, rad/s] in the axes of the base, shape
                (6,).
            accelerations: Accelerations of the end effector [m/s^2, rad/s^2] in the
                same axes, shape (n, 6).

        Returns:
            Joint velocities [rad/s]; then the joint accelerations [rad/s^2] for each of
            the given accelerations; then the joint accelerations for an end effector
            without acceleration. Shape (n + 2, 7).
        """
        count = len(accelerations)
        result = np.zeros((count + 2, _DOF))
        given = np.array([twist, *accelerations])
        np.matmul(given, self._of_twist.T, out=result[: count + 1])
        dq = result[0]
        result[1:] -= self._drift @ np.multiply.outer(dq, dq).ravel()
        return result


def _drift_of(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the acceleration per product of joint velocities, shape (6, 49)."""
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
