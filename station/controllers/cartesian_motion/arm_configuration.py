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


class ArmConfiguration:
    """One configuration of an arm with seven joints.

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
        gram = matrix.T @ matrix + _DAMPING * np.eye(_DOF)
        self._inverse = np.linalg.solve(gram, matrix.T)

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

    def joint_velocities(self, twist: Sequence[float]) -> NDArray[np.float64]:
        """Return the joint velocities of a twist [rad/s], shape (7,).

        Args:
            twist: Of the end effector [m/s, rad/s], axes of the base, shape (6,).
        """
        result: NDArray[np.float64] = self._inverse[:, :6] @ np.array(twist)
        return result

    def joint_accelerations(
        self, dq: NDArray[np.float64], accelerations: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return joint accelerations [rad/s^2], shape (7, n).

        Args:
            dq: Joint velocities [rad/s], shape (7,).
            accelerations: Of the end effector [m/s^2, rad/s^2], one in each column,
                shape (6, n).
        """
        v, z = self._matrix[:3], self._matrix[3:6]
        turning = z * dq
        after = np.cumsum(turning, axis=1)  # of the links, shape (3, 7)
        before = after - turning
        drift = np.concatenate([
            _cross_sum(after + before, v * dq),
            _cross_sum(before, turning),
        ])
        result: NDArray[np.float64] = self._inverse[:, :6] @ (
            accelerations - drift[:, None]
        )
        return result


def _cross_sum(
    first: NDArray[np.float64], second: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the sum of the cross products of columns, shape (3,)."""
    (a, b, c), (x, y, z) = first, second
    return np.array([b @ z - c @ y, c @ x - a @ z, a @ y - b @ x])
