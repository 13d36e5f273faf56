"""Capsules that enclose the links of a robot."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Vector3

_LEAST_GAIN = 0.85
"""Share of a capsule's volume at which two smaller ones are worth their time."""
_CUTS = np.linspace(0.2, 0.8, 7)


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


def enclose(link: str, vertices: NDArray[np.float64]) -> list[LinkCapsule]:
    """Return one or two capsules that together enclose the hull of some points.

    Args:
        link: Name of their link.
        vertices: The points in the frame of the link [m], shape (n, 3).
    """
    whole = _fit(vertices)
    best, cost = [whole], _volume(whole)
    axis = np.subtract(whole[1], whole[0])
    heights = vertices @ axis
    for share in _CUTS if np.any(axis) else ():
        cut = (1.0 - share) * heights.min() + share * heights.max()
        halves = _halves(vertices, heights - cut)
        if min(len(half) for half in halves) > 3:
            fits = [_fit(half) for half in halves]
            volume = sum(_volume(fit) for fit in fits)
            if volume < _LEAST_GAIN * cost:
                best, cost = fits, volume / _LEAST_GAIN
    return [_capsule(link, fit) for fit in best]


_Fit = tuple[NDArray[np.float64], NDArray[np.float64], float]


def _fit(points: NDArray[np.float64]) -> _Fit:
    """Return the smallest capsule about a few axes: ends and radius."""
    center = points.mean(axis=0)
    _, _, main = np.linalg.svd(points - center, full_matrices=False)
    fits = [_fit_along(points, axis) for axis in (*main, *np.eye(3))]
    return min(fits, key=_volume)


def _fit_along(points: NDArray[np.float64], axis: NDArray[np.float64]) -> _Fit:
    flat = points - np.outer(points @ axis, axis)
    middle, radius = _circle(flat)
    room = np.sqrt(np.maximum(0.0, radius**2 - ((flat - middle) ** 2).sum(axis=1)))
    along = points @ axis
    # The caps reach beyond the ends of the axis by what a point leaves of the radius.
    low, high = float((along + room).min()), float((along - room).max())
    if low > high:
        low = high = 0.5 * (low + high)
    # Points of the rim must not fall out through rounding or the search for the circle.
    first, second = middle + low * axis, middle + high * axis
    ends = np.clip(along, low, high)
    far = np.linalg.norm(points - middle - np.outer(ends, axis), axis=1).max()
    return first, second, max(radius, float(far)) + 1e-6


def _circle(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Return the centre and radius of nearly the smallest ball around some points."""
    center = 0.5 * (points.min(axis=0) + points.max(axis=0))
    # Badoiu and Clarkson's walk: a shrinking step towards the farthest point.
    for step in range(1, 150):
        far = points[((points - center) ** 2).sum(axis=1).argmax()]
        center = center + (far - center) / (step + 1.0)
    return center, float(np.sqrt(((points - center) ** 2).sum(axis=1).max()))


def _volume(fit: _Fit) -> float:
    first, second, radius = fit
    length = float(np.linalg.norm(second - first))
    return radius**2 * (length + 4.0 / 3.0 * radius)


def _halves(
    points: NDArray[np.float64], heights: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Return the points on both sides of a plane, each with those of the cut."""
    below, above = points[heights <= 0.0], points[heights > 0.0]
    low, high = heights[heights <= 0.0][:, None], heights[heights > 0.0][None]
    share = (-low / (high - low))[..., None]
    cut = (below[:, None] * (1.0 - share) + above[None] * share).reshape(-1, 3)
    return [np.vstack([half, cut]) for half in (below, above)]


def _capsule(link: str, fit: _Fit) -> LinkCapsule:
    first, second, radius = fit
    a, b = (tuple(float(v) for v in end) for end in (first, second))
    return LinkCapsule(link, (a[0], a[1], a[2]), (b[0], b[1], b[2]), radius)
