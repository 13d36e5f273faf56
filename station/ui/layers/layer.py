"""What the layers of the 3D view have in common."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import viser

from station.ui.layers.scene_facts import PlacedRobot, SceneFacts


class Layer(ABC):
    """Something over the robots in one browser. To be used from Viser's event loop.

    A layer exists while it is shown: what nobody looks at costs nothing.

    Args:
        client: The browser.
        robots: The robots in the scene.
    """

    def __init__(
        self, client: viser.ClientHandle, robots: Sequence[PlacedRobot]
    ) -> None:
        self.client = client
        self.robots = tuple(robots)
        self.nodes: list[viser.SceneNodeHandle] = []

    @abstractmethod
    def show(self, facts: SceneFacts) -> None:
        """Draw the newest facts; called about 15 times a second."""

    def remove(self) -> None:
        """Take everything out of the scene."""
        for node in self.nodes:
            node.remove()
        self.nodes.clear()
