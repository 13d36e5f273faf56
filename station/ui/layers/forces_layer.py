"""The layer with the forces on the arms."""

import math
from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray
from typing_extensions import override

from station.core.description.urdf import Pose
from station.ui.layers.layer import Layer
from station.ui.layers.scene_facts import PlacedRobot, SceneFacts, Vector
from station.wire import Contact

_LEAST = 2.0
"""Smaller forces of contacts are not drawn [N]."""
_LEAST_ESTIMATE = 8.0
"""Smaller wrenches are errors of the arm's estimate and not drawn [N]: an arm with the
sensors of a real one reports some 4 N where nothing touches it."""
_METRES_PER_NEWTON = 0.01
_LONGEST = 0.6  # [m]
_EXTERNAL = (200, 30, 30)
_SAME = 0.5  # [N]
_CONTACT = (120, 60, 190)
_POINT_SIZE = 0.012  # [m]


class ForcesLayer(Layer):
    """The external force on each Franka arm, as the arm estimates it, at its K frame.

    In simulation also the points at which bodies touch, with their forces.

    Args:
        client: The browser.
        robots: The robots in the scene.
    """

    def __init__(
        self, client: viser.ClientHandle, robots: Sequence[PlacedRobot]
    ) -> None:
        super().__init__(client, robots)
        self._arrows: dict[str, _Arrow] = {}
        self._contacts = _Contacts(client)

    @override
    def show(self, facts: SceneFacts) -> None:
        """Draw the forces that act now."""
        self._contacts.show(facts.contacts)
        for robot in self.robots:
            name = robot.model.arm_id
            arm = facts.arms.get(name)
            force = None if arm is None else arm.force
            if arm is None or force is None or math.hypot(*force) < _LEAST_ESTIMATE:
                if name in self._arrows:
                    self._arrows.pop(name).remove()
                continue
            poses = robot.poses(facts.positions)
            tool = poses[robot.flange].compose(arm.flange_to_tool)
            point = tool.compose(arm.tool_to_stiffness).xyz
            in_world = Pose((0.0,) * 3, poses[robot.base].quaternion)
            turned = in_world.compose(Pose(force)).xyz
            arrow = self._arrows.get(name)
            if arrow is None:
                arrow = _Arrow(self.client, f"/force_{name}", _EXTERNAL)
                self._arrows[name] = arrow
            arrow.show(point, turned)

    @override
    def remove(self) -> None:
        for arrow in self._arrows.values():
            arrow.remove()
        self._arrows.clear()
        self._contacts.remove()
        super().remove()


class _Arrow:
    """A force with its size written at its tail."""

    def __init__(
        self, client: viser.ClientHandle, path: str, colour: tuple[int, int, int]
    ) -> None:
        self._client, self._path, self._colour = client, path, colour
        self._shown: tuple[Vector, Vector] | None = None
        self._label = client.scene.add_label(f"{path}_label", "")
        self._drawn: viser.ArrowsHandle | None = None

    def show(self, point: Vector, force: Vector) -> None:
        """Draw a force [N] that acts at a point [m]; the arrow ends there."""
        if self._shown is not None:
            before, was = self._shown
            if math.dist(point, before) < 1e-3 and math.dist(force, was) < _SAME:
                return
        self._shown = (point, force)
        size = math.hypot(*force)
        length = min(size * _METRES_PER_NEWTON, _LONGEST)
        tip = np.array(point)
        tail = tip - length / size * np.array(force)
        self._drawn = self._client.scene.add_arrows(
            self._path,
            np.array([[tail, tip]], dtype=np.float32),
            self._colour,
            shaft_radius=0.006,
            head_radius=0.016,
            head_length=min(0.04, length),
        )
        text = f"{size:.0f} N on the arm"
        if self._label.text != text:
            self._label.text = text
        self._label.position = tuple(tail.tolist())

    def remove(self) -> None:
        """Take the arrow out of the scene."""
        self._label.remove()
        if self._drawn is not None:
            self._drawn.remove()


class _Contacts:
    """Points at which bodies touch, and the force on the second body of each."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client = client
        self._shown: NDArray[np.float64] = np.zeros((0, 2, 3))
        self._drawn: list[viser.SceneNodeHandle] = []

    def show(self, contacts: Sequence[Contact]) -> None:
        """Draw the contacts of now; what has not changed is not sent again."""
        known = [
            (contact.position, contact.force)
            for contact in contacts
            if None not in {*contact.position, *contact.force}
        ]
        now = np.array(known, dtype=float).reshape(-1, 2, 3)
        if now.shape == self._shown.shape:
            change = np.abs(now - self._shown)
            if (change[:, 0] < 1e-3).all() and (change[:, 1] < _SAME).all():
                return
        self._shown = now
        self.remove()
        if len(now):
            self._draw(now[:, 0], now[:, 1])

    def _draw(self, points: NDArray[np.float64], forces: NDArray[np.float64]) -> None:
        scene = self._client.scene
        self._drawn.append(
            scene.add_point_cloud(
                "/contacts/points",
                points.astype(np.float32),
                _CONTACT,
                point_size=_POINT_SIZE,
                point_shape="circle",
            )
        )
        sizes = np.linalg.norm(forces, axis=1, keepdims=True)
        strong = sizes[:, 0] > _LEAST
        if not strong.any():
            return
        lengths = np.minimum(sizes * _METRES_PER_NEWTON, _LONGEST)
        tips = points + forces / np.maximum(sizes, _LEAST) * lengths
        arrows = np.stack([points, tips], axis=1)[strong]  # (n, 2, 3)
        self._drawn.append(
            scene.add_arrows(
                "/contacts/forces",
                arrows.astype(np.float32),
                _CONTACT,
                shaft_radius=0.004,
                head_radius=0.011,
                head_length=0.025,
            )
        )

    def remove(self) -> None:
        """Take the contacts out of the scene."""
        for node in self._drawn:
            node.remove()
        self._drawn.clear()
