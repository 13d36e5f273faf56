"""Capsules that enclose the links of a robot."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Vector3


@dataclass(frozen=True, slots=True)
class LinkCapsule:
    """A capsule that is fixed to a link.

    Attributes:
        link: Name of the link.
        first: One end of the axis in the frame of the link [m].
        second: The other end [m].
        radius: Radius [m], > 0.
    """

    link: str
    first: Vector3
    second: Vector3
    radius: float

    def numbers(self) -> list[float]:
        """Return the ends [m] and the radius [m], 7 numbers."""
        return [*self.first, *self.second, self.radius]


# Steps towards the middle of the smallest circle; the last one is below 1 % of it.
_STEPS = 100
# Added to a radius for rounding [m].
_ROUNDING = 1e-6


def enclosing_capsule(link: str, points: NDArray[np.float64]) -> LinkCapsule:
    """Return a small capsule around points, and so around their convex hull.

    Args:
        link: Name of the link.
        points: Points in the frame of the link [m], shape (n, 3), n > 0.
    """
    middle = points.mean(axis=0)
    own = np.linalg.svd(points - middle, full_matrices=True)[2]
    found = [_along(axis, points) for axis in (*own, *np.eye(3))]
    radius, first, second = min(
        found, key=lambda one: one[0] ** 2 * (4 * one[0] + 3 * np.ptp(one[1:], 0).max())
    )
    ends = [(float(x), float(y), float(z)) for x, y, z in (first, second)]
    return LinkCapsule(link, ends[0], ends[1], float(radius) + _ROUNDING)


def _along(
    axis: NDArray[np.float64], points: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return radius and ends of a capsule around points with a given axis."""
    along = points @ axis
    across = points - along[:, None] * axis
    # Badoiu and Clarkson's steps to the middle of the smallest circle.
    middle = (across.min(axis=0) + across.max(axis=0)) / 2.0
    for step in range(2, _STEPS):
        farthest = across[np.argmax(np.linalg.norm(across - middle, axis=1))]
        middle = middle + (farthest - middle) / step**1.5
    far = np.linalg.norm(across - middle, axis=1)
    radius = float(far.max())
    room = np.sqrt(np.maximum(radius**2 - far**2, 0.0))
    # The caps begin as far inside as every point allows.
    low, high = (along + room).min(), (along - room).max()
    if low > high:
        low = high = (low + high) / 2.0
    middle = middle - (middle @ axis) * axis
    return radius, middle + low * axis, middle + high * axis
