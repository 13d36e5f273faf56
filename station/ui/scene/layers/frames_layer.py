"""The layer with the frames of the arms."""

from collections.abc import Sequence

import viser
from typing_extensions import override

from station.core.description.urdf import Pose
from station.ui.scene.layers.layer import Layer, PlacedRobot, SceneFacts

_LENGTH, _RADIUS = 0.11, 0.0035  # [m]
_SAME = 1e-4


class FramesLayer(Layer):
    """The base O, the flange F and, of a Franka arm, EE and K, with their names.

    Args:
        client: The browser.
        robots: The robots in the scene.
    """

    def __init__(
        self, client: viser.ClientHandle, robots: Sequence[PlacedRobot]
    ) -> None:
        super().__init__(client, robots)
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
            axes_length=_LENGTH,
            axes_radius=_RADIUS,
            position=pose.xyz,
            wxyz=pose.quaternion,
        )
        label = scene.add_label(f"{path}/name", text, position=(0.0, 0.0, 0.0))
        return [label, frame]


def _is_identity(pose: Pose) -> bool:
    apart = max(map(abs, (*pose.xyz, *pose.quaternion[1:])))
    return apart < _SAME
