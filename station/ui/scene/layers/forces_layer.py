"""The layer with the forces on the arms."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import viser
from numpy.typing import NDArray
from typing_extensions import override

from station.core.description.urdf import Pose, Vector3
from station.ui.scene.layers.layer import Layer, SceneFacts
from station.wire import Contact

_LEAST = 2.0
"""Smaller forces of contacts are not drawn [N]."""
_LEAST_ESTIMATE = 11.0
"""Smaller forces are errors of the arm's estimate and not drawn [N]: an arm with the
sensors and the friction of a real one reports some 4 N at rest where nothing touches
it, and up to 10.4 N while all its joints turn to and fro at up to 0.9 rad/s."""
_METRES_PER_NEWTON = 0.015
_LONGEST = 0.6  # [m]
_EXTERNAL = (200, 30, 30)
_SAME = 0.5  # [N]
_CONTACT = (120, 60, 190)
_POINT_SIZE = 0.012  # [m]


class ForcesLayer(Layer):
    """The external force on each Franka arm, as the arm estimates it, at its K frame.

    In simulation also the points at which bodies touch, with their forces. All arrows
    begin where the force acts, because the pushing body would hide an arrow that ends
    there.
    """

    @override
    def begin(self) -> None:
        self._arrows: dict[str, _Arrow] = {}
        links = {name for robot in self.robots for name in robot.model.urdf.links}
        self._contacts = _Contacts(self.client, links)
        self.nodes["/contacts"] = self._contacts

    @override
    def show(self, facts: SceneFacts) -> None:
        """Draw the forces that act now."""
        self._contacts.show(facts.contacts)
        for robot in self.robots:
            name = robot.model.arm_id
            arm = facts.arms.get(name)
            force = None if arm is None else arm.force
            if arm is None or force is None or math.hypot(*force) < _LEAST_ESTIMATE:
                self._arrows.pop(name, None)
                self.drop(f"/force_{name}")
                continue
            poses = robot.poses(facts.positions)
            tool = poses[robot.flange].compose(arm.flange_to_tool)
            point = tool.compose(arm.tool_to_stiffness).xyz
            in_world = Pose((0.0,) * 3, poses[robot.base].quaternion)
            turned = in_world.compose(Pose(force)).xyz
            arrow = self._arrows.get(name)
            if arrow is None:
                arrow = _Arrow(self.client, f"/force_{name}", _EXTERNAL)
                self._arrows[name] = self.nodes[f"/force_{name}"] = arrow
            arrow.show(point, turned)


class _Arrow:
    """A force with its size written at its tip."""

    def __init__(
        self, client: viser.ClientHandle, path: str, colour: tuple[int, int, int]
    ) -> None:
        self._client, self._path, self._colour = client, path, colour
        self._shown: tuple[Vector3, Vector3] | None = None
        self._label = client.scene.add_label(f"{path}_label", "")
        self._drawn: viser.ArrowsHandle | None = None

    def show(self, point: Vector3, force: Vector3) -> None:
        """Draw a force [N] that acts at a point [m]; the arrow begins there."""
        # Noise would send a new arrow 15 times a second.
        if self._shown is not None:
            before, was = self._shown
            if math.dist(point, before) < 1e-3 and math.dist(force, was) < _SAME:
                return
        self._shown = (point, force)
        size = math.hypot(*force)
        length = min(size * _METRES_PER_NEWTON, _LONGEST)
        tail = np.array(point)
        tip = tail + length / size * np.array(force)
        self._drawn = self._client.scene.add_arrows(
            self._path,
            np.array([[tail, tip]], dtype=np.float32),
            self._colour,
            shaft_radius=0.008,
            head_radius=0.02,
            head_length=min(0.05, length),
        )
        text = f"{size:.0f} N on the arm"
        if self._label.text != text:
            self._label.text = text
        self._label.position = tuple(tip.tolist())

    def remove(self) -> None:
        """Take the arrow out of the scene."""
        self._label.remove()
        if self._drawn is not None:
            self._drawn.remove()


@dataclass(frozen=True, slots=True)
class _Touch:
    """A point at which two bodies touch.

    Attributes:
        text: Names of the touching bodies.
        point: The point [m], shape (3,).
        force: Force on the body that `text` names first: a link of a robot, if either
            body is one [N], shape (3,).
        is_of_robot: Whether one of the two bodies is a link of a robot.
    """

    text: str
    point: NDArray[np.float64]
    force: NDArray[np.float64]
    is_of_robot: bool


class _Contacts:
    """Points at which bodies touch, each with the force on one of the two bodies."""

    def __init__(self, client: viser.ClientHandle, links: Collection[str]) -> None:
        self._client = client
        self._links = frozenset(links)
        self._shown: NDArray[np.float64] = np.zeros((0, 2, 3))
        self._drawn: list[viser.SceneNodeHandle] = []
        self._label = client.scene.add_label("/contacts/label", "", visible=False)

    def show(self, contacts: Sequence[Contact]) -> None:
        """Draw the present contacts; unchanged ones are not sent again."""
        touches = [
            _touch(contact, self._links)
            for contact in contacts
            if None not in {*contact.position, *contact.force}
        ]
        now = np.array([(one.point, one.force) for one in touches]).reshape(-1, 2, 3)
        if now.shape == self._shown.shape:
            change = np.abs(now - self._shown)
            if (change[:, 0] < 1e-3).all() and (change[:, 1] < _SAME).all():
                return
        self._shown = now
        self._clear()
        if len(now):
            self._draw(now[:, 0], now[:, 1])
        self._name_strongest(touches)

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
                shaft_radius=0.006,
                head_radius=0.015,
                head_length=0.03,
            )
        )

    def _name_strongest(self, touches: Sequence[_Touch]) -> None:
        """Name the two bodies that press most; others stay unnamed.

        A grasping hand touches at eight points, which eight texts would hide.
        """
        pairs: dict[str, list[_Touch]] = {}
        for one in touches:
            if one.is_of_robot:
                pairs.setdefault(one.text, []).append(one)
        sums = {text: sum(one.force for one in found) for text, found in pairs.items()}
        sizes = {text: float(np.linalg.norm(force)) for text, force in sums.items()}
        text = max(sizes, key=sizes.__getitem__, default="")
        self._label.visible = bool(text) and sizes[text] > _LEAST
        if self._label.visible:
            self._label.text = f"{text}, {sizes[text]:.0f} N"
            self._label.position = tuple(pairs[text][0].point.tolist())

    def _clear(self) -> None:
        for node in self._drawn:
            node.remove()
        self._drawn.clear()

    def remove(self) -> None:
        """Take the contacts out of the scene."""
        self._clear()
        self._label.remove()


def _touch(contact: Contact, links: Collection[str]) -> _Touch:
    """Return a contact as it is drawn: with the force on the robot, if there is one."""
    first, second = contact.bodies
    force = np.array(contact.force, dtype=float)
    if first in links and second not in links:
        force = -force
    else:
        first, second = second, first
    other = "the floor" if second == "world" else second
    return _Touch(
        text=f"{first} touches {other}",
        point=np.array(contact.position, dtype=float),
        force=force,
        is_of_robot=first in links,
    )
