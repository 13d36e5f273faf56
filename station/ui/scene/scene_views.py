"""The views of browser sessions: layers, ghosts and cameras of their own.

Viser knows browsers, the gateway knows sessions: the relay hands Viser the key of the
session, so that a session's choice is drawn in its own browsers only.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray
from typing_extensions import override

from station.ui.scene.camera import look
from station.ui.scene.joint_frames import is_drawn_moving
from station.ui.scene.layers.drag_layers import MoveLayer, Pushing, PushLayer
from station.ui.scene.layers.forces_layer import ForcesLayer
from station.ui.scene.layers.layer import Layer, PlacedRobot, SceneFacts
from station.ui.scene.layers.robot_layers import (
    CommandedLayer,
    FramesLayer,
    LimitsLayer,
    TrailLayer,
)
from station.ui.scene.robot_scene import RobotFigure

_BRAND = (34, 110, 196)
_LIGHT = ((214.0, 222.0, 231.0), (246.0, 248.0, 250.0))
"""The backdrop's colours at the top and at the bottom."""
_DARK = ((30.0, 36.0, 44.0), (48.0, 56.0, 66.0))
_COLLISION_COLOUR = (224, 112, 32)
_COLLISION_OPACITY = 0.45
MOST_KEPT = 512
"""Sessions whose choice is kept; those that chose longest ago are forgotten first."""
PUSH = "push"
"""The layer in which links are pulled."""
_MOVE = "move"
"""The layer in which the object that a session has chosen is moved."""
AT_FIRST = frozenset({"command", "forces", "limits"})
"""The layers of a session that has not chosen."""
_GHOST_COLOUR = (138, 84, 214)
_LABEL_HEIGHT = 0.05  # [m]
_SAME_PLACE = 1e-3  # [m]
_UNPLACED = (3.0, 3.0, 3.0)
"""Position of the camera in a page that has not read its initial position yet [m]."""


class CollisionLayer(Layer):
    """The collision geometry of all links, translucent over their visual shapes."""

    @override
    def begin(self) -> None:
        for robot in self.robots:
            for link, surface in robot.model.surfaces.items():
                path = f"{robot.node_of(link)}/collision"
                self.nodes[path] = surface.draw(
                    self.client.scene, path, _COLLISION_COLOUR, _COLLISION_OPACITY
                )

    @override
    def show(self, facts: SceneFacts) -> None:
        """Do nothing: the geometry hangs from the links and moves with them."""


LAYERS: Mapping[str, type[Layer]] = {
    "command": CommandedLayer,
    "forces": ForcesLayer,
    "limits": LimitsLayer,
    "trail": TrailLayer,
    "frames": FramesLayer,
    "collision": CollisionLayer,
}
"""The layers that any session may choose."""


@dataclass(frozen=True, slots=True)
class Ghost:
    """A pose that a session looks at, recorded or planned.

    Attributes:
        positions: Joint positions by name [rad] or [m].
        label: The name of the pose, shown above it; may be empty.
    """

    positions: Mapping[str, float]
    label: str = ""


@dataclass(slots=True)
class _Drawn:
    """The choice of a session as one browser shows it."""

    client: viser.ClientHandle
    is_framed: bool = False
    layers: dict[str, Layer] = field(default_factory=dict)
    figures: list[RobotFigure] = field(default_factory=list)
    label: viser.LabelHandle | None = None


class SceneViews:
    """The views of all sessions. To be used from Viser's event loop only.

    Args:
        robots: The robots that are drawn.
        key_of: Returns the key of the session of a browser; empty when it is unknown.
        pushing: Pushes links and moves objects for browsers.
        first_place: Returns the initial position of every camera [m], shape (3,).
    """

    def __init__(
        self,
        robots: Sequence[PlacedRobot],
        key_of: Callable[[viser.ClientHandle], str],
        pushing: Pushing,
        first_place: Callable[[], ArrayLike],
    ) -> None:
        self._first_place = first_place
        self._pushing = pushing
        self._robots = tuple(robots)
        self._key_of = key_of
        self._ghosts: dict[str, Ghost] = {}
        self._chosen: dict[str, frozenset[str]] = {}
        self._dark: dict[str, bool] = {}
        self._gripped: dict[str, str] = {}
        self._covered: dict[str, float] = {}
        self._facts = SceneFacts()
        self._drawn: dict[int, _Drawn] = {}

    def joint_names(self) -> frozenset[str]:
        """Return the joints that a ghost can have a position for."""
        return frozenset(
            joint.name
            for robot in self._robots
            for joint in robot.model.urdf.joints.values()
            if is_drawn_moving(joint)
        )

    def joined(self, client: viser.ClientHandle) -> None:
        """Show a newly connected browser the choices of its session."""
        self._drawn[client.client_id] = _Drawn(client)
        if self._dark.get(self._key_of(client)):
            paint(client, is_dark=True)
        self._lay(self._drawn[client.client_id])
        self._show_ghost(self._drawn[client.client_id])
        self._frame(self._drawn[client.client_id])

    def left(self, client: viser.ClientHandle) -> None:
        """Forget a browser."""
        gone = self._drawn.pop(client.client_id, None)
        if gone is not None and PUSH in gone.layers:
            gone.layers.pop(PUSH).remove()

    def show_ghost(self, key: str, ghost: Ghost | None) -> None:
        """Show a pose in the browsers of one session.

        Args:
            key: Key of the session.
            ghost: The pose; None hides it.
        """
        if ghost is None:
            self._ghosts.pop(key, None)
        else:
            _keep(self._ghosts, key, ghost)
        for drawn in self._of(key):
            self._show_ghost(drawn)

    def choose(self, key: str, layers: Collection[str]) -> None:
        """Show these layers, and no others, in the browsers of one session.

        Args:
            key: Key of the session.
            layers: Names out of `LAYERS`.
        """
        _keep(self._chosen, key, frozenset(layers))
        for drawn in self._of(key):
            self._lay(drawn)

    def grip(self, key: str, name: str) -> None:
        """Show arrows at an object, which move it, in the browsers of one session.

        Args:
            key: Key of the session.
            name: The object; empty for none.
        """
        _keep(self._gripped, key, name)
        for drawn in self._of(key):
            if _MOVE in drawn.layers:
                drawn.layers.pop(_MOVE).remove()
            self._lay(drawn)

    def look(self, key: str, preset: str, covered: float = 0.0) -> None:
        """Let the browsers of one session look from another place.

        Args:
            key: Key of the session.
            preset: One of `camera.PRESETS`.
            covered: Part of the picture that the page hides, see `camera.look`.
        """
        positions = self._facts.positions
        for drawn in self._of(key):
            look(drawn.client, preset, self._robots, positions, covered)

    def opened(self, key: str, covered: float) -> None:
        """Fit the robots into the part of the 3D view that a page leaves visible.

        Browsers in which somebody has moved the camera keep their view.

        Args:
            key: Key of the session.
            covered: Part of the 3D view that the page hides, see `camera.look`.
        """
        _keep(self._covered, key, covered)
        for drawn in self._of(key):
            self._frame(drawn)

    def paint(self, key: str, *, is_dark: bool) -> None:
        """Let the views of one session be light or dark, as its page is.

        Args:
            key: Key of the session.
            is_dark: Whether its page is dark.
        """
        if self._dark.get(key, False) == is_dark:
            return  # A page says so again whenever its station is back.
        _keep(self._dark, key, is_dark)
        for drawn in self._of(key):
            paint(drawn.client, is_dark=is_dark)

    def alive(self, key: str) -> None:
        """Note that the page of a session still runs, so that its pull goes on.

        Args:
            key: Key of the session.
        """
        for drawn in self._of(key):
            layer = drawn.layers.get(PUSH)
            if isinstance(layer, PushLayer):
                layer.alive()

    def wanted(self) -> frozenset[str]:
        """Return the layers that at least one browser shows now."""
        return frozenset(name for one in self._drawn.values() for name in one.layers)

    def refresh(self, facts: SceneFacts) -> None:
        """Draw the newest facts in all browsers."""
        self._facts = facts
        # A copy, because browsers come and go while messages are sent.
        for drawn in list(self._drawn.values()):
            self._frame(drawn)
            with drawn.client.atomic():
                for layer in drawn.layers.values():
                    layer.show(facts)

    def _of(self, key: str) -> list[_Drawn]:
        return [one for one in self._drawn.values() if self._key_of(one.client) == key]

    def _frame(self, drawn: _Drawn) -> None:
        """Let a browser begin with all robots in sight, as soon as they are known."""
        covered = self._covered.get(self._key_of(drawn.client))
        positions = self._facts.positions
        if drawn.is_framed or covered is None or not positions:
            return
        place = drawn.client.camera.position
        # The page has yet to move its camera to its first place.
        if _is_same(place, _UNPLACED):
            return
        drawn.is_framed = True
        # A person who has moved the camera wants to keep it.
        if _is_same(place, self._first_place()):
            look(drawn.client, "fit", self._robots, positions, covered)

    def _lay(self, drawn: _Drawn) -> None:
        key = self._key_of(drawn.client)
        wanted = self._chosen.get(key, AT_FIRST)
        if self._gripped.get(key):
            wanted |= {_MOVE}
        for name in drawn.layers.keys() - wanted:
            drawn.layers.pop(name).remove()
        for name in wanted - drawn.layers.keys():
            drawn.layers[name] = self._layer(name, drawn.client)
            drawn.layers[name].show(self._facts)

    def _layer(self, name: str, client: viser.ClientHandle) -> Layer:
        key = self._key_of(client)
        if name == PUSH:
            return PushLayer(client, self._robots, self._pushing, key)
        if name == _MOVE:
            return MoveLayer(client, self._pushing, key, self._gripped[key])
        return LAYERS[name](client, self._robots)

    def _show_ghost(self, drawn: _Drawn) -> None:
        ghost = self._ghosts.get(self._key_of(drawn.client), Ghost({}))
        if not drawn.figures and ghost.positions:
            drawn.figures = [
                RobotFigure(drawn.client, robot.model, f"/ghost_{i}", _GHOST_COLOUR)
                for i, robot in enumerate(self._robots)
            ]
            drawn.label = drawn.client.scene.add_label("/ghost_label", "")
        tops = []
        joints = ghost.positions.keys()
        for robot, figure in zip(self._robots, drawn.figures, strict=False):
            if joints & robot.model.urdf.joints.keys():
                figure.show(ghost.positions)
                tops.append(robot.model.bounds(figure.positions))
            else:
                figure.hide()
        if drawn.label is not None:
            drawn.label.text = ghost.label
            drawn.label.visible = bool(ghost.label and tops)
        if drawn.label is not None and tops:
            x, y, _ = tops[0].mean(axis=0)
            top = float(tops[0][1, 2]) + _LABEL_HEIGHT
            drawn.label.position = (float(x), float(y), top)


def _is_same(place: ArrayLike, other: ArrayLike) -> bool:
    """Return whether two positions [m] are the same; their shape is (3,)."""
    return float(np.abs(np.subtract(place, other)).max()) < _SAME_PLACE


_Value = TypeVar("_Value")


def _keep(kept: dict[str, _Value], key: str, value: _Value) -> None:
    """Keep a value as the newest one; beyond `MOST_KEPT`, forget the oldest."""
    kept.pop(key, None)
    kept[key] = value
    if len(kept) > MOST_KEPT:
        kept.pop(next(iter(kept)))


def paint(target: viser.ViserServer | viser.ClientHandle, *, is_dark: bool) -> None:
    """Paint the backdrop and the panel.

    Args:
        target: Everybody's view, or that of one browser.
        is_dark: Whether the page around it is dark.
    """
    target.gui.configure_theme(
        dark_mode=is_dark,
        show_logo=False,
        show_share_button=False,
        brand_color=_BRAND,
    )
    target.scene.set_background_image(backdrop(is_dark=is_dark), format="png")


def backdrop(*, is_dark: bool) -> NDArray[np.uint8]:
    """Return a soft vertical gradient, shape (rows, 2, 3)."""
    rows = np.linspace(0.0, 1.0, 64)[:, None]
    top, bottom = np.array(_DARK if is_dark else _LIGHT)
    column = (1.0 - rows) * top + rows * bottom  # (64, 3)
    return np.repeat(column[:, None, :], 2, axis=1).astype(np.uint8)
