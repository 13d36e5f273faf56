"""Layers in which a person drags: the pull at a link, and the place of an object.

A pull is a force on a simulated arm. Each request pushes for `PUSH_TIME` and is
repeated while the pointer holds the link and the page says that it still runs. So the
push ends by itself when the browser, the dashboard or the link between them is lost.
"""

import asyncio
import math
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np
import viser
from typing_extensions import override

from station.client import ApiError
from station.core.description.urdf import Pose, Vector3
from station.ui.scene.layers.layer import Layer, PlacedRobot, SceneFacts
from station.wire import ExternalForce

PUSH_TIME = 0.2
"""Duration of the push of one request [s]."""
PUSH_PERIOD = 0.1
"""Time between two requests [s]."""
ALIVE_FOR = 0.3
"""Time for which a page counts as running after its last message [s]."""
STIFFNESS = 80.0
"""Force for each metre between the link and the pointer [N/m]."""
STRONGEST = 40.0
"""Largest force [N]."""
_COLOUR = (22, 102, 196)
_OPACITY = 0.22
_ARROW = "/push_force"
_ARROWS_SIZE = 0.25
_HELD_FOR = 1.0
"""Time after a drag in which the arrows stay where they were let go [s]."""


class Pusher(Protocol):
    """Pushes a link for one session."""

    async def __call__(self, key: str, arm_id: str, push: ExternalForce, /) -> None:
        """Push; raises `ApiError` with the station's refusal."""
        ...


async def act_for_nobody(key: str, *_: object) -> None:
    """Refuse, as a dashboard without sessions does.

    Raises:
        ApiError: Always.
    """
    detail = f"There is no session '{key}'."
    raise ApiError(detail, status=403, code="forbidden")


@dataclass(frozen=True, slots=True)
class Pushing:
    """Functions by which the browsers of a session push links and move objects.

    Attributes:
        send: Pushes for a session.
        refused: Called with a refusal and the browser that pulled.
        now: Monotonic clock [s].
        move: Moves an object for a session to a position [m]; raises `ApiError`.
    """

    send: Pusher
    refused: Callable[[ApiError, viser.ClientHandle], None]
    now: Callable[[], float] = time.monotonic
    move: Callable[[str, str, list[float]], Awaitable[None]] = act_for_nobody


@dataclass(frozen=True, slots=True)
class _Pull:
    """A link that the pointer holds: the point on it, and where the pointer is [m]."""

    robot: PlacedRobot
    link: str
    point: Vector3
    pointer: Vector3


class PushLayer(Layer):
    """Links that can be pulled, and the force of the pull.

    Args:
        client: The browser.
        robots: The robots in the scene.
        pushing: Pushes links for this browser.
        key: Key of its session.
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        robots: Sequence[PlacedRobot],
        pushing: Pushing,
        key: str,
    ) -> None:
        super().__init__(client, robots)
        self._pushing = pushing
        self._key = key
        self._pull: _Pull | None = None
        self._positions: dict[str, float] = {}
        self._arms: frozenset[str] = frozenset()
        self._alive_at = -math.inf
        self._sent_at = -math.inf
        self._sending: asyncio.Task[None] | None = None
        self._arrow: viser.ArrowsHandle | None = None
        for robot in self.robots:
            for link, surface in robot.model.surfaces.items():
                path = f"{robot.node_of(link)}/push"
                node = surface.draw(
                    client.scene, path, _COLOUR, _OPACITY, is_flat=False
                )
                node.on_drag("left")(partial(self._on_drag, robot, link))
                self.nodes[path] = node

    def alive(self) -> None:
        """Note that the page still runs."""
        self._alive_at = self._pushing.now()

    @override
    def show(self, facts: SceneFacts) -> None:
        """Push while the pointer holds a link, and draw the force."""
        self._positions = dict(facts.positions)
        self._arms = frozenset(facts.arms)
        now = self._pushing.now()
        # Viser reports no end of a drag when a page hangs or is cut off.
        if self._pull is not None and now - self._alive_at > ALIVE_FOR:
            self._pull = None
        if self._pull is None:
            self._draw(None)
            return
        pull = self._pull
        pose = pull.robot.poses(self._positions)[pull.link]
        grip = pose.compose(Pose(pull.point)).xyz
        force = pull_force(grip, pull.pointer)
        self._draw((grip, force))
        # A station that answers slowly must not collect pushes.
        is_idle = self._sending is None or self._sending.done()
        if is_idle and now - self._sent_at >= PUSH_PERIOD:
            self._sent_at = now
            self._sending = asyncio.create_task(self._send(pull, force))

    @override
    def remove(self) -> None:
        self._pull = self._arrow = None
        super().remove()

    async def _on_drag(
        self,
        robot: PlacedRobot,
        link: str,
        event: viser.SceneNodeDragEvent[viser.MeshHandle],
    ) -> None:
        if event.phase == "end":
            self._pull = None
            return
        if robot.model.arm_id not in self._arms:
            return  # Only an arm of the station has a route by which it is pushed.
        if event.phase == "start" or self._pull is None:
            pose = robot.poses(self._positions)[link]
            point = pose.inverse().compose(Pose(event.start_position)).xyz
        else:
            point = self._pull.point
        self._pull = _Pull(robot, link, point, event.end_position)

    async def _send(self, pull: _Pull, force: Vector3) -> None:
        push = ExternalForce(
            link=pull.link,
            force=list(force),
            duration=PUSH_TIME,
            point=list(pull.point),
        )
        try:
            await self._pushing.send(self._key, pull.robot.model.arm_id, push)
        except ApiError as error:
            # Repeated, the same refusal would come ten times a second.
            self._pull = None
            self._pushing.refused(error, self.client)

    def _draw(self, drawn: tuple[Vector3, Vector3] | None) -> None:
        """Draw a force [N] at a point [m]; None draws nothing."""
        if drawn is None or not any(drawn[1]):
            self._arrow = None
            self.drop(_ARROW)
            return
        grip, force = np.array(drawn[0]), np.array(drawn[1])
        points = np.array([[grip, grip + force / STIFFNESS]], dtype=np.float32)
        if self._arrow is not None:
            self._arrow.points = points
            return
        self.nodes[_ARROW] = self._arrow = self.client.scene.add_arrows(
            _ARROW,
            points,
            _COLOUR,
            shaft_radius=0.006,
            head_radius=0.016,
            head_length=0.04,
        )


def pull_force(grip: Vector3, pointer: Vector3) -> Vector3:
    """Return the force of a spring between link and pointer [N], at most `STRONGEST`.

    Args:
        grip: The point on the link, in the world [m].
        pointer: Position of the pointer [m].
    """
    away = math.dist(grip, pointer)
    strength = min(STIFFNESS, STRONGEST / away) if away else 0.0
    x, y, z = (strength * (b - a) for a, b in zip(grip, pointer, strict=True))
    return (x, y, z)


class MoveLayer(Layer):
    """Arrows at one object. To be used from Viser's event loop only.

    Args:
        client: The browser.
        acting: Moves objects for this browser.
        key: Key of its session.
        name: The object.
    """

    def __init__(
        self, client: viser.ClientHandle, acting: Pushing, key: str, name: str
    ) -> None:
        super().__init__(client, ())
        self._acting = acting
        self._key = key
        self.name = name
        self._dragged_at = -math.inf
        self._wanted: list[float] | None = None
        self._sending: asyncio.Task[None] | None = None
        self._arrows = client.scene.add_transform_controls(
            "/moved_object",
            scale=_ARROWS_SIZE,
            disable_rotations=True,
            depth_test=False,
            visible=False,
        )
        self._arrows.on_update(self._on_drag)
        self.nodes["/moved_object"] = self._arrows

    @override
    def show(self, facts: SceneFacts) -> None:
        """Let the arrows follow the object until a person drags them."""
        found = next((one for one in facts.objects if one.name == self.name), None)
        if self._arrows.visible != (found is not None):
            self._arrows.visible = found is not None
        # Arrows that followed while they are dragged would fight with the pointer.
        if found is None or self._acting.now() - self._dragged_at < _HELD_FOR:
            return
        x, y, z = (value or 0.0 for value in found.position)
        if math.dist((x, y, z), self._arrows.position) > 1e-4:
            self._arrows.position = (x, y, z)

    async def _on_drag(self, event: viser.TransformControlsEvent) -> None:
        if event.client is None:
            return  # Viser also calls this when the arrows follow.
        self._dragged_at = self._acting.now()
        self._wanted = [float(value) for value in event.target.position]
        # Of quick drags the newest is sent, once the station has answered.
        if self._sending is None or self._sending.done():
            self._sending = asyncio.create_task(self._send())

    async def _send(self) -> None:
        try:
            while self._wanted is not None:
                wanted, self._wanted = self._wanted, None
                await self._acting.move(self._key, self.name, wanted)
        except ApiError as error:
            self._wanted, self._dragged_at = None, -math.inf
            self._acting.refused(error, self.client)
