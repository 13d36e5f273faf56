"""From where a browser looks at the robots."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import viser

from station.ui.layers.scene_facts import PlacedRobot

_DIRECTIONS: Mapping[str, tuple[float, float, float]] = {
    "fit": (0.76, -0.58, 0.293),
    "front": (1.0, 0.0, 0.0),
    "side": (0.0, -1.0, 0.0),
    # Not quite from above: straight down there is no way that is up.
    "top": (-0.02, 0.0, 1.0),
}
"""Direction from what is looked at to the camera."""
PRESETS = (*_DIRECTIONS, "hand")
_ROOM_AROUND = 1.05
_HAND_DISTANCE = 0.75  # [m]


def look(
    client: viser.ClientHandle,
    preset: str,
    robots: Sequence[PlacedRobot],
    positions: Mapping[str, float],
) -> None:
    """Let a browser look from another place.

    Args:
        client: The browser.
        preset: One of `PRESETS`. All but `hand` show all robots; `hand` looks at the
            flange of the first one from near.
        robots: The robots; without any nothing happens.
        positions: Joint positions by name [rad] or [m].
    """
    if not robots:
        return
    camera = client.camera
    if preset == "hand":
        robot = robots[0]
        target = np.array(robot.poses(positions)[robot.flange].xyz)
        distance = _HAND_DISTANCE
        direction = np.array(_DIRECTIONS["fit"])
    else:
        corners = np.stack([robot.model.bounds(positions) for robot in robots])
        low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
        target = (low + high) / 2.0
        radius = float(np.linalg.norm(high - low)) / 2.0
        # The narrower of the two angles decides; the vertical one is the lens's.
        half = camera.fov / 2.0
        half = min(half, math.atan(math.tan(half) * camera.aspect))
        distance = _ROOM_AROUND * radius / math.sin(half)
        direction = np.array(_DIRECTIONS[preset])
    direction /= np.linalg.norm(direction)
    with client.atomic():
        camera.up_direction = (0.0, 0.0, 1.0)
        camera.position = target + distance * direction
        camera.look_at = target
