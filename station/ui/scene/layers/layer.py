"""A layer over the robots, and the frozen data that layers draw."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import viser

from station.core.description.urdf import Pose, Vector3
from station.ui.link.station_view import ArmFacts, Limits
from station.ui.scene.joint_frames import is_drawn_moving, link_path, link_poses
from station.ui.scene.robot_model import RobotModel
from station.wire import Contact, SceneObject


@dataclass(frozen=True, slots=True)
class PlacedRobot:
    """A robot in the scene.

    Attributes:
        model: The robot.
        root: Its scene node.
    """

    model: RobotModel
    root: str

    def node_of(self, link: str) -> str:
        """Return the scene node of a link."""
        return link_path(self.model.urdf, link, self.root)

    @property
    def base(self) -> str:
        """The link that carries the first joint, whose frame a Franka calls O."""
        urdf = self.model.urdf
        link = self.model.root
        while below := urdf.joints_below(link):
            if is_drawn_moving(below[0]):
                break
            link = below[0].child
        return link

    @property
    def flange(self) -> str:
        """The link that carries the tool: a Panda's flange, or a robot's last link."""
        links = self.model.urdf.links
        own = f"{self.model.arm_id}_link8"
        if own in links:
            return own
        return max(links, key=lambda link: self.node_of(link).count("/"))

    def poses(self, positions: Mapping[str, float]) -> dict[str, Pose]:
        """Return the pose of every link in the world."""
        return link_poses(self.model.urdf, positions)


@dataclass(frozen=True, slots=True)
class SceneFacts:
    """The newest data that layers may draw.

    Attributes:
        positions: Measured joint positions by name [rad] or [m].
        commanded: Positions that running controllers want their joints to have.
        limits: Lowest and highest position by joint.
        arms: The tools of the Franka arms and the forces on them, by arm_id.
        contacts: The points at which bodies of a simulated world touch.
        trails: The path of the flange of each robot, oldest point first [m], world.
        objects: The things around the robots.
    """

    positions: Mapping[str, float] = field(default_factory=dict)
    commanded: Mapping[str, float] = field(default_factory=dict)
    limits: Limits = field(default_factory=dict)
    arms: Mapping[str, ArmFacts] = field(default_factory=dict)
    contacts: Sequence[Contact] = ()
    trails: Sequence[Sequence[Vector3]] = ()
    objects: Sequence[SceneObject] = ()


class Removable(Protocol):
    """A removable part of a scene: a node, or several nodes."""

    def remove(self) -> None:
        """Take the part out of the scene."""


class Layer(ABC):
    """A layer over the robots in one browser. To be used from Viser's event loop.

    A layer exists while it is shown; a hidden layer costs nothing.

    Args:
        client: The browser.
        robots: The robots in the scene.

    Attributes:
        nodes: Everything that the layer has drawn, by its path.
    """

    def __init__(
        self, client: viser.ClientHandle, robots: Sequence[PlacedRobot]
    ) -> None:
        self.client = client
        self.robots = tuple(robots)
        self.nodes: dict[str, Removable] = {}
        self.begin()

    def begin(self) -> None:  # noqa: B027 - a layer need not keep anything
        """Make the nodes that the layer keeps from one call of `show` to the next."""

    @abstractmethod
    def show(self, facts: SceneFacts) -> None:
        """Draw the newest facts; called about 15 times a second."""

    def drop(self, *paths: str) -> None:
        """Take some of what is drawn out of the scene."""
        for path in paths:
            if path in self.nodes:
                self.nodes.pop(path).remove()

    def remove(self) -> None:
        """Take everything out of the scene."""
        self.drop(*self.nodes)
