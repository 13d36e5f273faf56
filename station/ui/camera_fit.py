"""How far a camera has to stand back to see all of some boxes."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

UP = (0.0, 0.0, 1.0)
"""Direction that is up in every picture."""


def corners_of(boxes: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the corners of boxes.

    Args:
        boxes: Lowest and highest corner of each box [m], each of shape (2, 3).

    Returns:
        All corners [m], shape (8 n, 3).
    """
    picks = np.array([[i >> k & 1 for k in range(3)] for i in range(8)])  # (8, 3)
    return np.concatenate([box[picks, range(3)] for box in boxes])


def fitting_distance(
    corners: NDArray[np.float64],
    target: NDArray[np.float64],
    direction: NDArray[np.float64],
    *,
    field_of_view: float,
    aspect: float,
) -> float:
    """Return the least distance from which a camera has all corners in its picture.

    Args:
        corners: The points to see [m], shape (n, 3).
        target: The point in the middle of the picture [m], shape (3,).
        direction: From the target to the camera, of length 1 and not straight up.
        field_of_view: Vertical angle of the camera [rad].
        aspect: Width of the picture over its height.
    """
    right = np.cross(UP, direction)
    right /= np.linalg.norm(right)
    above = np.cross(direction, right)
    away = corners - target
    tall = math.tan(field_of_view / 2.0)
    wide = tall * aspect
    nearer = away @ direction
    needed = np.stack([abs(away @ right) / wide, abs(away @ above) / tall])
    return float((nearer + needed).max())
