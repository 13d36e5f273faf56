"""Quaternions w x y z, as NumPy arrays of shape (4,) and unit length."""
# ruff: noqa: N803 - R is a rotation matrix.

from math import sqrt

import numpy as np
from numpy.typing import NDArray


def quaternion_of(R: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the quaternion of a rotation matrix, shape (3, 3)."""
    # The largest of the four parts is at least 0.5, so that dividing by it is safe.
    squares = np.array([
        1.0 + R[0, 0] + R[1, 1] + R[2, 2],
        1.0 + R[0, 0] - R[1, 1] - R[2, 2],
        1.0 - R[0, 0] + R[1, 1] - R[2, 2],
        1.0 - R[0, 0] - R[1, 1] + R[2, 2],
    ])
    largest = int(np.argmax(squares))
    products = np.array([
        [squares[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]],
        [R[2, 1] - R[1, 2], squares[1], R[1, 0] + R[0, 1], R[0, 2] + R[2, 0]],
        [R[0, 2] - R[2, 0], R[1, 0] + R[0, 1], squares[2], R[2, 1] + R[1, 2]],
        [R[1, 0] - R[0, 1], R[0, 2] + R[2, 0], R[2, 1] + R[1, 2], squares[3]],
    ])
    result: NDArray[np.float64] = products[largest] / (2.0 * sqrt(squares[largest]))
    return result


def matrix_of(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation matrix of a unit quaternion, shape (3, 3)."""
    w, v = q[0], q[1:]
    skew = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    result: NDArray[np.float64] = np.eye(3) + 2.0 * w * skew + 2.0 * skew @ skew
    return result
