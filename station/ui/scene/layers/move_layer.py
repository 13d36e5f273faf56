"""The layer in which an object is moved: arrows at it, which a person drags."""

import asyncio
import math

import viser
from typing_extensions import override

from station.client import ApiError
from station.ui.scene.layers.layer import Layer, SceneFacts
from station.ui.scene.layers.push_layer import Pushing

_ARROWS_SIZE = 0.25
_HELD_FOR = 1.0
"""Time after a drag in which the arrows stay where they were let go [s]."""


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
