"""The layer that tints links whose joint is near a limit."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import viser
from typing_extensions import override

from station.core.description.urdf import Joint
from station.ui.scene.layers.layer import Layer, PlacedRobot, SceneFacts

NEAR = 0.05
"""Share of a joint's range next to each limit that counts as near it."""
_COLOUR = (235, 94, 0)
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
    """Tints the link that a joint near its limit moves, and shows the room left.

    Args:
        client: The browser.
        robots: The robots in the scene.
    """

    def __init__(
        self, client: viser.ClientHandle, robots: Sequence[PlacedRobot]
    ) -> None:
        super().__init__(client, robots)
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
                scene, f"{node}/tint", _COLOUR, _OPACITY, scale=_LARGER, is_flat=False
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
