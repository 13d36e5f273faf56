"""Checks of homogeneous transforms.

Poses have 16 numbers, flat and column-major.
"""

from collections.abc import Sequence
from math import isfinite, sqrt

from station.core.errors import InvalidCommandError

_UNIT_TOLERANCE = 1e-5
_ROTATION_TOLERANCE = 1e-4
_LARGEST_OFFSET = 10.0
"""Largest coordinate of a frame's origin [m]; more is a mistake in millimetres."""


def transform_problem(pose: Sequence[float]) -> str | None:
    """Return the reason why numbers are not a homogeneous transform, or None.

    Orthogonality and handedness are not tested.

    Args:
        pose: The numbers.

    Source:
        libfranka@0.9.2 src/control_tools.cpp, isHomogeneousTransformation.
    """
    if len(pose) != 16 or not isfinite(sum(pose)):
        return "it must be 16 finite numbers"
    if pose[3] or pose[7] or pose[11] or pose[15] != 1.0:
        return "its last row must be 0, 0, 0, 1"
    a, b, c, _, d, e, f, _, g, h, i = pose[:11]
    for x, y, z in ((a, b, c), (d, e, f), (g, h, i), (a, d, g), (b, e, h), (c, f, i)):
        if abs(sqrt(x * x + y * y + z * z) - 1.0) > _UNIT_TOLERANCE:
            return "the rows and columns of its rotation must have length 1"
    return None


def check_transform(pose: Sequence[float], what: str) -> list[float]:
    """Return the pose as a new list; stricter than `transform_problem`.

    Axes that are left-handed or not at right angles, and origins more than 10 m away,
    are refused, too. A frame is set once and used in every later cycle, so an error
    would make all poses and wrenches wrong.

    Args:
        pose: The numbers.
        what: Name of the field, for the message.

    Raises:
        InvalidCommandError: The numbers are not such a transform.
    """
    problem = transform_problem(pose)
    if problem is None and abs(_determinant(pose) - 1.0) > _ROTATION_TOLERANCE:
        problem = "the axes of its rotation must be at right angles and right-handed"
    if problem is None and max(map(abs, pose[12:15])) > _LARGEST_OFFSET:
        problem = f"the origin must be at most {_LARGEST_OFFSET:g} m away on each axis"
    if problem is not None:
        raise InvalidCommandError(
            f"'{what}' {list(pose)} is no transform: {problem}.",
            remedy="Give a homogeneous transform in metres, column by column.",
            details={
                "errors": [
                    {"field": f"body/{what}", "message": problem, "value": str(pose)}
                ]
            },
        )
    return list(pose)


def _determinant(pose: Sequence[float]) -> float:
    """Return the determinant of the rotation: x . (y x z) of its columns."""
    a, b, c = pose[0:3], pose[4:7], pose[8:11]
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
