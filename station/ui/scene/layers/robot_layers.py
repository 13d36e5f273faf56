"""Layers that show a robot's frames, its limits, its commanded pose and its trail."""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from typing_extensions import override

from station.core.description.urdf import Joint, Pose, Vector3
from station.ui.scene.layers.layer import Layer, PlacedRobot, SceneFacts
from station.ui.scene.robot_scene import RobotFigure

if TYPE_CHECKING:
    import viser

_AXIS_LENGTH, _AXIS_RADIUS = 0.11, 0.0035  # [m]
_SAME = 1e-4


class FramesLayer(Layer):
    """The base O, the flange F and, of a Franka arm, EE and K, with their names."""

    @override
    def begin(self) -> None:
        self._tools: dict[str, tuple[Pose, Pose]] = {}
        for robot in self.robots:
            base, flange = robot.node_of(robot.base), robot.node_of(robot.flange)
            self._name(f"{base}/frame_O", "O", Pose())
            self._name(f"{flange}/frame_F", "F", Pose())

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
            tool, stiffness = wanted
            own, other = (
                f"{robot.node_of(robot.flange)}/frame_{end}" for end in ("EE", "K")
            )
            self.drop(*_paths(own), *_paths(other))
            label = "EE, K" if _is_identity(stiffness) else "EE"
            self._name(own, label, tool)
            if label == "EE":
                self._name(other, "K", tool.compose(stiffness))

    def _name(self, path: str, text: str, pose: Pose) -> None:
        """Draw a frame with its name."""
        scene = self.client.scene
        frame = scene.add_frame(
            path,
            axes_length=_AXIS_LENGTH,
            axes_radius=_AXIS_RADIUS,
            position=pose.xyz,
            wxyz=pose.quaternion,
        )
        label = scene.add_label(f"{path}/name", text, position=(0.0, 0.0, 0.0))
        self.nodes |= dict(zip(_paths(path), (label, frame), strict=True))


def _paths(frame: str) -> tuple[str, str]:
    """Return the paths of a frame's name and of the frame, in which the name is."""
    return f"{frame}/name", frame


def _is_identity(pose: Pose) -> bool:
    apart = max(map(abs, (*pose.xyz, *pose.quaternion[1:])))
    return apart < _SAME


NEAR = 0.05
"""Share of a joint's range next to each limit that counts as near it."""
_NEAR_COLOUR = (235, 94, 0)
_OPACITY = 0.6
_LARGER = 1.02


class LimitsLayer(Layer):
    """Tints each link whose joint is near a limit, and shows the angle to the limit."""

    @override
    def begin(self) -> None:
        self._labels: dict[str, viser.LabelHandle] = {}  # by the node of the link

    @override
    def show(self, facts: SceneFacts) -> None:
        """Tint the links of joints that are near a limit now, and no others."""
        for robot in self.robots:
            for joint in robot.model.urdf.joints.values():
                node = robot.node_of(joint.child)
                said = nearness(joint, facts)
                if said:
                    self._tint(robot, joint.child, said)
                elif self._labels.pop(node, None):
                    self.drop(f"{node}/near_limit", f"{node}/tint")

    def _tint(self, robot: PlacedRobot, link: str, said: str) -> None:
        node = robot.node_of(link)
        label = self._labels.get(node)
        if label is not None:
            if label.text != said:
                label.text = said
            return
        scene = self.client.scene
        self._labels[node] = scene.add_label(f"{node}/near_limit", said)
        self.nodes[f"{node}/near_limit"] = self._labels[node]
        if surface := robot.model.surfaces.get(link):
            path, colour = f"{node}/tint", _NEAR_COLOUR
            self.nodes[path] = surface.draw(
                scene, path, colour, _OPACITY, scale=_LARGER, is_flat=False
            )


def nearness(joint: Joint, facts: SceneFacts) -> str:
    """Return the text on a joint that is near a limit; empty for another.

    Fingers never count as near, because they reach their limits in normal use.
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
"""Distances of a joint from its command [rad] or [m]: the figure is shown above the
first, and hidden below the second, so that it does not flicker."""


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
                    path = f"/commanded_{i}"
                    figure = RobotFigure(
                        self.client, robot.model, path, _COMMANDED_COLOUR
                    )
                    label = self.client.scene.add_label(f"{path}_label", _LABEL)
                    self._figures[i], self._labels[i] = figure, label
                    self.nodes |= {path: figure, f"{path}_label": label}
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

    @override
    def show(self, facts: SceneFacts) -> None:
        """Draw the trails that have become longer."""
        for i, path in enumerate(facts.trails):
            if len(path) < 2 or self._shown[i] == path[-1]:
                continue
            self._shown[i] = path[-1]
            points = np.array(path, dtype=np.float32)
            segments = np.stack([points[:-1], points[1:]], axis=1)  # (n, 2, 3)
            self.nodes[f"/trail_{i}"] = self.client.scene.add_line_segments(
                f"/trail_{i}", segments, _TRAIL_COLOUR, thickness=_THICKNESS
            )
