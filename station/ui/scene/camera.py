"""The places from which a browser looks at the robots."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from station.ui.scene.layers.layer import PlacedRobot

UP = (0.0, 0.0, 1.0)
"""Direction that is up in every picture."""
_DIRECTIONS: Mapping[str, tuple[float, float, float]] = {
    "fit": (0.76, -0.58, 0.293),
    "front": (1.0, 0.0, 0.0),
    "side": (0.0, -1.0, 0.0),
    # Not quite from above: straight down there is no way that is up.
    "top": (-0.02, 0.0, 1.0),
}
"""Direction from the target to the camera."""
PRESETS = (*_DIRECTIONS, "hand")
_ROOM_AROUND = 1.1
_HAND_DISTANCE = 0.75  # [m]


def look(
    client: viser.ClientHandle,
    preset: str,
    robots: Sequence[PlacedRobot],
    positions: Mapping[str, float],
    covered: float = 0.0,
) -> None:
    """Move the camera of a browser to a preset place.

    Args:
        client: The browser.
        preset: One of `PRESETS`. All but `hand` show all robots; `hand` looks at the
            flange of the first one from near.
        robots: The robots to show; the camera stays when there are none.
        positions: Joint positions by name [rad] or [m].
        covered: Share of the picture, at its left, that the page hides, 0 to less than
            1: the robots are fitted into the rest.
    """
    if not robots:
        return
    camera = client.camera
    if preset == "hand":
        robot = robots[0]
        target = np.array(robot.poses(positions)[robot.flange].xyz)
        distance = _HAND_DISTANCE
        direction = _unit("fit")
    else:
        corners = corners_of([robot.model.bounds(positions) for robot in robots])
        target = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
        direction = _unit(preset)
        free = camera.aspect * (1.0 - covered)
        distance = _ROOM_AROUND * fitting_distance(
            corners, target, direction, field_of_view=camera.fov, aspect=free
        )
        half_width = distance * math.tan(camera.fov / 2.0) * camera.aspect
        target = target - covered * half_width * _right_of(direction)
    with client.atomic():
        camera.up_direction = UP
        camera.position = target + distance * direction
        camera.look_at = target


def _right_of(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rightward direction in a camera's picture, length 1."""
    right = np.cross(UP, direction)
    unit: NDArray[np.float64] = right / np.linalg.norm(right)
    return unit


def _unit(preset: str) -> NDArray[np.float64]:
    """Return the direction of a preset, of length 1."""
    direction = np.array(_DIRECTIONS[preset])
    direction /= np.linalg.norm(direction)
    return direction


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
