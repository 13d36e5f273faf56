"""The layer with the geometry that collides."""

from collections.abc import Sequence

import viser
from typing_extensions import override

from station.ui.layers.layer import Layer
from station.ui.layers.scene_facts import PlacedRobot, SceneFacts

_COLOUR = (224, 112, 32)
_OPACITY = 0.45


class CollisionLayer(Layer):
    """The collision geometry of all links, translucent over what they look like.

    Args:
        client: The browser.
        robots: The robots in the scene.
    """

    def __init__(
        self, client: viser.ClientHandle, robots: Sequence[PlacedRobot]
    ) -> None:
        super().__init__(client, robots)
        for robot in self.robots:
            for link, surface in robot.model.surfaces.items():
                node = client.scene.add_mesh_simple(
                    f"{robot.node_of(link)}/collision",
                    surface.vertices,
                    surface.faces,
                    color=_COLOUR,
                    opacity=_OPACITY,
                    flat_shading=True,
                    cast_shadow=False,
                    receive_shadow=False,
                )
                self.nodes.append(node)

    @override
    def show(self, facts: SceneFacts) -> None:
        """Do nothing: the geometry hangs from the links and moves with them."""
