"""The layer with the path of each flange, and the paths themselves."""

import math
from collections import deque
from collections.abc import Mapping, Sequence

import numpy as np
import viser
from typing_extensions import override

from station.core.description.urdf import Vector3
from station.ui.scene.layers.layer import Layer, PlacedRobot, SceneFacts

_MOST_POINTS = 600
_STEP = 0.004
"""Least distance between two points of a trail [m]: 2.4 m of the path are kept."""
_COLOUR = (196, 34, 96)
_THICKNESS = 0.006  # [m]


class Trails:
    """The paths of the flanges.

    Args:
        robots: The robots in the scene.
    """

    def __init__(self, robots: Sequence[PlacedRobot]) -> None:
        self._robots = [(robot, robot.flange) for robot in robots]
        self._paths: list[deque[Vector3]] = [
            deque(maxlen=_MOST_POINTS) for _ in self._robots
        ]

    def note(self, positions: Mapping[str, float]) -> list[list[Vector3]]:
        """Note the places of the flanges, and return their paths.

        Args:
            positions: Joint positions by name [rad] or [m].

        Returns:
            A path for each robot [m], in the world, oldest point first.
        """
        for (robot, flange), path in zip(self._robots, self._paths, strict=True):
            here = robot.poses(positions)[flange].xyz
            if not path or math.dist(here, path[-1]) > _STEP:
                path.append(here)
        return [list(path) for path in self._paths]


class TrailLayer(Layer):
    """The last metres of the path of each flange.

    Args:
        client: The browser.
        robots: The robots in the scene.
    """

    def __init__(
        self, client: viser.ClientHandle, robots: Sequence[PlacedRobot]
    ) -> None:
        super().__init__(client, robots)
        self._shown: list[Vector3 | None] = [None] * len(self.robots)
        self._lines: dict[int, viser.LineSegmentsHandle] = {}

    @override
    def show(self, facts: SceneFacts) -> None:
        """Draw the trails that have become longer."""
        for i, path in enumerate(facts.trails):
            if len(path) < 2 or self._shown[i] == path[-1]:
                continue
            self._shown[i] = path[-1]
            points = np.array(path, dtype=np.float32)
            segments = np.stack([points[:-1], points[1:]], axis=1)  # (n, 2, 3)
            self._lines[i] = self.client.scene.add_line_segments(
                f"/trail_{i}", segments, _COLOUR, thickness=_THICKNESS
            )

    @override
    def remove(self) -> None:
        for line in self._lines.values():
            line.remove()
        super().remove()
