"""Layers that show a robot's frames, its limits, its commanded pose and its trail."""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import viser
from typing_extensions import override

from station.core.description.urdf import Joint, Pose, Vector3
from station.ui.scene.layers.layer import Layer, PlacedRobot, SceneFacts
from station.ui.scene.robot_figure import RobotFigure

_AXIS_LENGTH, _AXIS_RADIUS = 0.11, 0.0035  # [m]
_SAME = 1e-4


class FramesLayer(Layer):
    """The base O, the flange F and, of a Franka arm, EE and K, with their names."""

    @override
    def begin(self) -> None:
        self._tools: dict[str, tuple[Pose, Pose]] = {}
        self._of_tools: dict[str, list[viser.SceneNodeHandle]] = {}
        for robot in self.robots:
            base, flange = robot.node_of(robot.base), robot.node_of(robot.flange)
            self.nodes += self._named(f"{base}/frame_O", "O", Pose())
            self.nodes += self._named(f"{flange}/frame_F", "F", Pose())

    @override
    def show(self, facts: SceneFacts) -> None:
        """Draw EE and K where the arms have them."""
        for robot in self.robots:
            arm = facts.arms.get(robot.model.arm_id)
            if arm is None:
                continue
            wanted = (arm.flange_to_tool, arm.tool_to_stiffness)
            name = robot.model.arm_id
            if self._tools.get(name) == wanted:
                continue
            self._tools[name] = wanted
            for node in self._of_tools.pop(name, ()):
                node.remove()
            tool, stiffness = wanted
            parent = robot.node_of(robot.flange)
            label = "EE, K" if _is_identity(stiffness) else "EE"
            drawn = self._named(f"{parent}/frame_EE", label, tool)
            if label == "EE":
                drawn += self._named(f"{parent}/frame_K", "K", tool.compose(stiffness))
            self._of_tools[name] = drawn

    @override
    def remove(self) -> None:
        for drawn in self._of_tools.values():
            for node in drawn:
                node.remove()
        super().remove()

    def _named(self, path: str, text: str, pose: Pose) -> list[viser.SceneNodeHandle]:
        scene = self.client.scene
        frame = scene.add_frame(
            path,
            axes_length=_AXIS_LENGTH,
            axes_radius=_AXIS_RADIUS,
            position=pose.xyz,
            wxyz=pose.quaternion,
        )
        label = scene.add_label(f"{path}/name", text, position=(0.0, 0.0, 0.0))
        return [label, frame]


def _is_identity(pose: Pose) -> bool:
    apart = max(map(abs, (*pose.xyz, *pose.quaternion[1:])))
    return apart < _SAME


NEAR = 0.05
"""Share of a joint's range next to each limit that counts as near it."""
_NEAR_COLOUR = (235, 94, 0)
_OPACITY = 0.6
_LARGER = 1.02


@dataclass(frozen=True, slots=True)
class _Tint:
    label: viser.LabelHandle
    mesh: viser.MeshHandle | None

    def remove(self) -> None:
        self.label.remove()
        if self.mesh is not None:
            self.mesh.remove()


class LimitsLayer(Layer):
    """Tints the link that a joint near its limit moves, and shows the room left."""

    @override
    def begin(self) -> None:
        self._tinted: dict[str, _Tint] = {}

    @override
    def show(self, facts: SceneFacts) -> None:
        """Tint the links of joints that are near a limit now, and no others."""
        near: dict[str, str] = {}
        for robot in self.robots:
            for name, joint in robot.model.urdf.joints.items():
                said = nearness(joint, facts)
                if said:
                    near[name] = said
                    self._tint(robot, joint, said)
        for name in [name for name in self._tinted if name not in near]:
            self._tinted.pop(name).remove()

    @override
    def remove(self) -> None:
        for tint in self._tinted.values():
            tint.remove()
        self._tinted.clear()
        super().remove()

    def _tint(self, robot: PlacedRobot, joint: Joint, said: str) -> None:
        tint = self._tinted.get(joint.name)
        if tint is not None:
            if tint.label.text != said:
                tint.label.text = said
            return
        scene = self.client.scene
        node = robot.node_of(joint.child)
        label = scene.add_label(f"{node}/near_limit", said)
        surface = robot.model.surfaces.get(joint.child)
        mesh = (
            None
            if surface is None
            else surface.draw(
                scene,
                f"{node}/tint",
                _NEAR_COLOUR,
                _OPACITY,
                scale=_LARGER,
                is_flat=False,
            )
        )
        self._tinted[joint.name] = _Tint(label, mesh)


def nearness(joint: Joint, facts: SceneFacts) -> str:
    """Return the text on a joint that is near a limit; empty for another.

    Fingers open and close to their ends as they should and are never near.
    """
    ends, q = facts.limits.get(joint.name), facts.positions.get(joint.name)
    # A finger is at an end whenever the hand is open or closed.
    if ends is None or q is None or not joint.type.is_rotation:
        return ""
    low, high = ends
    room = min(q - low, high - q)
    if not room < NEAR * (high - low):
        return ""
    end = "lower" if q - low < high - q else "upper"
    degrees = math.degrees(room)
    return f"{joint.name}: {degrees:.0f}° to its {end} limit"


_COMMANDED_COLOUR = (22, 140, 160)
_LABEL = "commanded pose"
_LABEL_HEIGHT = 0.15
"""Height of the words over the highest frame of a link [m]."""
_APART, _TOGETHER = 0.03, 0.015
"""Largest distance of a joint to its command from which the figure is shown, and below
which it goes [rad] or [m]; a difference keeps it from flickering."""


class CommandedLayer(Layer):
    """A figure of each robot at its commanded pose, while the robot is elsewhere."""

    @override
    def begin(self) -> None:
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
                        self.client, robot.model, f"/commanded_{i}", _COMMANDED_COLOUR
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


_MOST_POINTS = 600
_STEP = 0.004
"""Least distance between two points of a trail [m]: 2.4 m of the path are kept."""
_TRAIL_COLOUR = (196, 34, 96)
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
    """The last metres of the path of each flange."""

    @override
    def begin(self) -> None:
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
                f"/trail_{i}", segments, _TRAIL_COLOUR, thickness=_THICKNESS
            )

    @override
    def remove(self) -> None:
        for line in self._lines.values():
            line.remove()
        super().remove()
