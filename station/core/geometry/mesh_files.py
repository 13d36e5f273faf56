"""Mesh files of objects around robots, and their convex hulls."""

from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from station.core.errors import RobotDescriptionError
from station.core.geometry import distances
from station.memory.doubles import doubles, zeros

_MAX_BYTES = 200_000_000
# First bytes of a file that Git LFS has not fetched.
_PLACEHOLDER = b"version https://git-lfs"
_MOST_CORNERS = 40


def check_mesh_file(path: Path) -> None:
    """Refuse a file that cannot be a mesh, before it is read.

    Args:
        path: The file.

    Raises:
        RobotDescriptionError: The file has no extension, is missing or too large, or is
            only the placeholder of a file that Git LFS has not fetched.
    """
    # Only the extension tells the readers which format to expect.
    if not path.suffix:
        raise RobotDescriptionError(
            f"The mesh file {path} has no extension, so that its format is not known.",
            remedy="Give the file the extension of its format, such as .stl or .obj.",
        )
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            begin = file.read(len(_PLACEHOLDER))
    except OSError as exc:
        raise RobotDescriptionError(
            f"The mesh file {path} cannot be read: {exc.strerror}.",
            remedy="Check the path and its permissions.",
        ) from exc
    # A larger mesh takes all memory, or minutes, before MuJoCo refuses it.
    if size > _MAX_BYTES:
        raise RobotDescriptionError(
            f"The mesh file {path} has {size} bytes; a mesh may have {_MAX_BYTES}.",
            remedy="Use a mesh of fewer triangles; only its convex hull collides.",
        )
    if begin == _PLACEHOLDER:
        raise RobotDescriptionError(
            f"The mesh file {path} is the placeholder of a large file.",
            remedy="Run 'git lfs pull' where it was checked out.",
        )


def mesh_vertices(path: Path) -> NDArray[np.float64]:
    """Return the corners of a mesh [m], shape (n, 3).

    Args:
        path: An OBJ file, or an STL file, binary or text.

    Raises:
        RobotDescriptionError: Fewer than four corners can be read from the file.
    """
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    try:
        if len(data) == 84 + 50 * count:
            rows = np.frombuffer(data, np.uint8, offset=84).reshape(count, 50)
            corners = rows[:, 12:48].copy().view("<f4").reshape(-1, 3)
        else:
            word = "v " if path.suffix.lower() == ".obj" else "vertex "
            lines = data.decode(errors="replace").splitlines()
            found = [one.split()[1:4] for one in lines if one.strip().startswith(word)]
            corners = np.array(found, dtype=float).reshape(-1, 3)
    except ValueError:
        corners = np.empty((0, 3))
    if len(corners) < 4 or not np.isfinite(corners).all():
        raise RobotDescriptionError(
            f"The mesh file {path} has no corners that can be read.",
            remedy="Give an STL or OBJ file.",
        )
    return np.unique(corners.astype(float), axis=0)


def add_hull(vertices: NDArray[np.float64], triangles: list[float]) -> float:
    """Add the triangles of a convex hull that uses only some of the given points.

    Args:
        vertices: The points [m], shape (n, 3).
        triangles: Receives the corners [m], 9 numbers per triangle.

    Returns:
        Distance by which the points reach beyond these triangles [m], >= 0.

    Raises:
        RobotDescriptionError: The points lie in a plane.
    """
    # Evenly spread directions: points of the golden spiral on a sphere.
    turn = np.arange(4 * _MOST_CORNERS) + 0.5
    polar = np.arccos(1.0 - turn / (2.0 * _MOST_CORNERS))
    around = np.pi * (1.0 + 5.0**0.5) * turn
    ways = np.stack([
        np.cos(around) * np.sin(polar), np.sin(around) * np.sin(polar), np.cos(polar),
    ])  # fmt: skip
    chosen = np.unique((vertices @ ways).argmax(axis=0))
    while len(chosen) > _MOST_CORNERS:
        chosen = chosen[:: 1 + len(chosen) // _MOST_CORNERS]
    corners, size = vertices[chosen], float(np.ptp(vertices, axis=0).max())
    begin, seen = len(triangles), set()
    for i, j, k in combinations(range(len(corners)), 3):
        normal = np.cross(corners[j] - corners[i], corners[k] - corners[i])
        area = float(np.linalg.norm(normal))
        if area < 1e-9 * size * size:
            continue
        heights = (corners - corners[i]) @ (normal / area)
        if heights.max() > 1e-7 * size:
            if heights.min() < -1e-7 * size:
                continue
            normal, heights = -normal, -heights
        face = np.flatnonzero(heights > -1e-7 * size)
        if tuple(face) not in seen:
            seen.add(tuple(face))
            triangles += _fan(corners[face], normal / area)
    solid = zeros(distances.ROW)
    if len(triangles) - begin < 36:
        raise RobotDescriptionError(
            "A mesh that a robot is to keep clear of lies in a plane.",
            remedy="Give one with a volume, or a box.",
        )
    solid[0], solid[1], solid[5], solid[9] = distances.MESH, 1.0, 1.0, 1.0
    solid[18], solid[19] = begin // 9, (len(triangles) - begin) // 9
    nearness = distances.Nearness(solid, doubles(triangles))
    return max(0.0, max(nearness.of_mesh(x, y, z, 0) for x, y, z in vertices))


def _fan(corners: NDArray[np.float64], normal: NDArray[np.float64]) -> list[float]:
    """Return triangles of a convex face, corners counter-clockwise about its normal."""
    middle = corners.mean(axis=0)
    first = corners[0] - middle
    second = np.cross(normal, first)
    angles = np.arctan2((corners - middle) @ second, (corners - middle) @ first)
    ring = corners[np.argsort(angles)]
    return [
        float(value)
        for i in range(1, len(ring) - 1)
        for corner in (ring[0], ring[i], ring[i + 1])
        for value in corner
    ]
