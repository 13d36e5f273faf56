"""Capsules that enclose the links of a robot."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, hypot
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Pose, Vector3
from station.core.errors import SceneRefusedError
from station.core.geometry.scene import SceneObject, mesh_vertices

_MOST_STRIPS = 4
"""Largest number of capsules side by side that enclose a box; a single one would be as
thick as the box is wide."""


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


def enclosing_capsules(thing: SceneObject, grip: Pose) -> list[LinkCapsule]:
    """Return capsules around an object, in the frame of the hand that carries it.

    Args:
        thing: The object.
        grip: Pose of the object's middle in that frame.

    Raises:
        RobotDescriptionError: The file of a mesh cannot be read.
        SceneRefusedError: The object is a half-space, which no arm can carry.
    """
    if thing.kind == "sphere":
        return [LinkCapsule(thing.name, grip.xyz, grip.xyz, thing.size[0])]
    if thing.kind in {"capsule", "cylinder"}:
        radius, half = thing.size[0], thing.size[1] / 2.0
        ends = [grip.compose(Pose((0.0, 0.0, z))).xyz for z in (-half, half)]
        return [LinkCapsule(thing.name, ends[0], ends[1], radius)]
    middle, edges = _box(thing)
    long, wide, thin = np.argsort(edges)[::-1].tolist()
    strips = min(_MOST_STRIPS, max(1, ceil(edges[wide] / max(edges[thin], 1e-3))))
    width = edges[wide] / strips
    radius = 0.5 * hypot(width, edges[thin])
    found = []
    for strip in range(strips):
        points = []
        for side in (-0.5, 0.5):
            point = middle.copy()
            point[long] += side * edges[long]
            point[wide] += (strip + 0.5) * width - 0.5 * edges[wide]
            x, y, z = point.tolist()
            points.append(grip.compose(Pose((x, y, z))).xyz)
        found.append(LinkCapsule(thing.name, points[0], points[1], radius))
    return found


def load_of(
    things: Sequence[tuple[SceneObject, Pose]],
) -> tuple[float, list[float], list[float]]:
    """Return mass, centre of mass and inertia of some objects as one body.

    A capsule counts as a cylinder of its whole length, a mesh as the box around it.

    Args:
        things: The objects and the poses of their middles in the frame of the load.

    Returns:
        The mass [kg]; the centre of mass [m], shape (3,); the inertia about it in the
        axes of the frame [kg m^2], 9 numbers.
    """
    mass = sum(thing.mass for thing, _ in things)
    if mass == 0.0:
        return 0.0, [0.0] * 3, [0.0] * 9
    centers = np.array([grip.xyz for _, grip in things])
    weights = np.array([thing.mass for thing, _ in things]) / mass
    center = weights @ centers
    inertia = np.zeros((3, 3))
    for (thing, grip), place in zip(things, centers - center, strict=True):
        axes = np.array([
            np.subtract(grip.compose(Pose(unit)).xyz, grip.xyz)
            for unit in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        ]).T
        inertia += axes @ np.diag(_inertia(thing)) @ axes.T
        inertia += thing.mass * (place @ place * np.eye(3) - np.outer(place, place))
    return mass, center.tolist(), inertia.T.ravel().tolist()


def _inertia(thing: SceneObject) -> list[float]:
    """Return the inertia about the axes of an object [kg m^2], shape (3,)."""
    m = thing.mass
    if thing.kind == "sphere":
        return [0.4 * m * thing.size[0] ** 2] * 3
    if thing.kind in {"capsule", "cylinder"}:
        radius, length = thing.size
        length += 2.0 * radius if thing.kind == "capsule" else 0.0
        across = m * (3.0 * radius**2 + length**2) / 12.0
        return [across, across, 0.5 * m * radius**2]
    a, b, c = _box(thing)[1].tolist()
    return [
        m * (b * b + c * c) / 12.0,
        m * (a * a + c * c) / 12.0,
        m * (a * a + b * b) / 12.0,
    ]


def _box(thing: SceneObject) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return middle and edges of the box around an object, in its frame [m].

    Raises:
        RobotDescriptionError: The file of a mesh cannot be read.
        SceneRefusedError: No box encloses it: it is a half-space.
    """
    if thing.kind == "mesh":
        corners = mesh_vertices(Path(thing.file))
        low, high = corners.min(axis=0), corners.max(axis=0)
        return (low + high) / 2.0, high - low
    if len(thing.size) != 3:
        raise SceneRefusedError(
            f"'{thing.name}' is a {thing.kind}, which no hand carries.",
            remedy="Attach a box, sphere, cylinder, capsule or mesh.",
            details={"object": thing.name},
        )
    return np.zeros(3), np.array(thing.size)
