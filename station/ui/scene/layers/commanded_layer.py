"""The layer with the commanded pose."""

from collections.abc import Sequence

import viser
from typing_extensions import override

from station.ui.scene.layers.layer import Layer, PlacedRobot, SceneFacts
from station.ui.scene.robot_figure import RobotFigure

_COLOUR = (22, 140, 160)
_LABEL = "commanded pose"
_LABEL_HEIGHT = 0.15
"""Height of the words over the highest frame of a link [m]."""
_APART, _TOGETHER = 0.03, 0.015
"""Largest distance of a joint to its command from which the figure is shown, and below
which it goes [rad] or [m]; a difference keeps it from flickering."""


class CommandedLayer(Layer):
    """A figure of each robot at its commanded pose, while the robot is elsewhere.

    Args:
        client: The browser.
        robots: The robots in the scene.
    """

    def __init__(
        self, client: viser.ClientHandle, robots: Sequence[PlacedRobot]
    ) -> None:
        super().__init__(client, robots)
        self._figures: list[RobotFigure | None] = [None] * len(self.robots)
        self._labels: dict[int, viser.LabelHandle] = {}

    @override
    def show(self, facts: SceneFacts) -> None:
        """Show the figures of robots that are not at their commanded poses."""
        for i, robot in enumerate(self.robots):
            figure = self._figures[i]
            apart = _distance(robot, facts)
            is_shown = figure is not None and figure.is_shown
            if apart > (_TOGETHER if is_shown else _APART):
                # Made when it is first needed: its meshes are sent to the browser.
                if figure is None:
                    figure = RobotFigure(
                        self.client, robot.model, f"/commanded_{i}", _COLOUR
                    )
                    self._figures[i] = figure
                    path = f"/commanded_{i}_label"
                    self._labels[i] = self.client.scene.add_label(path, _LABEL)
                commanded = {**facts.positions, **facts.commanded}
                figure.show(commanded)
                highest = max(
                    (pose.xyz for pose in robot.poses(commanded).values()),
                    key=lambda xyz: xyz[2],
                )
                x, y, z = highest
                self._labels[i].position = (x, y, z + _LABEL_HEIGHT)
                self._labels[i].visible = True
            elif figure is not None:
                figure.hide()
                self._labels[i].visible = False

    @override
    def remove(self) -> None:
        for figure in self._figures:
            if figure is not None:
                figure.remove()
        for label in self._labels.values():
            label.remove()
        super().remove()


def _distance(robot: PlacedRobot, facts: SceneFacts) -> float:
    """Return the largest distance between a robot's joints and their commands."""
    return max(
        (
            abs(wanted - facts.positions[joint])
            for joint, wanted in facts.commanded.items()
            if joint in robot.model.urdf.joints and joint in facts.positions
        ),
        default=0.0,
    )
