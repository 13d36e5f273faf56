"""A second, translucent figure of a robot at a commanded or planned pose."""

from collections.abc import Mapping

from station.ui.scene.joint_frames import (
    MovingFrame,
    MovingFrames,
    Place,
    is_drawn_moving,
    link_path,
)
from station.ui.scene.robot_model import RobotModel

Colour = tuple[int, int, int]


class RobotFigure:
    """The collision geometry of a robot, drawn as one figure. Viser's event loop only.

    The collision geometry has a hundredth of the triangles of the visual meshes,
    so that every browser can have figures of its own.

    Args:
        place: Node of the scene that shows the robot.
        robot: The robot.
        root: Name of its scene node.
        colour: Its colour.
        opacity: 0 to 1.

    Attributes:
        frames: The frames that its joints move.
    """

    def __init__(
        self,
        place: Place,
        robot: RobotModel,
        root: str,
        colour: Colour,
        opacity: float = 0.4,
    ) -> None:
        scene = place.scene
        self._root = scene.add_frame(root, show_axes=False, visible=False)
        moving = []
        for joint in robot.urdf.joints.values():
            path = link_path(robot.urdf, joint.child, root)
            origin = joint.origin
            handle = scene.add_frame(
                path, show_axes=False, wxyz=origin.quaternion, position=origin.xyz
            )
            if is_drawn_moving(joint):
                moving.append(MovingFrame(joint, handle))
            surface = robot.surfaces.get(joint.child)
            if surface is not None:
                surface.draw(scene, f"{path}/surface", colour, opacity)
        self.frames = MovingFrames(place, moving)

    @property
    def is_shown(self) -> bool:
        """Return whether the figure can be seen."""
        return self._root.visible

    @property
    def positions(self) -> Mapping[str, float]:
        """The joint positions at which it stands [rad] or [m]."""
        return self.frames.shown

    def show(self, positions: Mapping[str, float]) -> None:
        """Show the figure at these joint positions [rad] or [m]."""
        self.frames.show(positions)
        if not self._root.visible:
            self._root.visible = True

    def hide(self) -> None:
        """Show nothing."""
        if self._root.visible:
            self._root.visible = False

    def remove(self) -> None:
        """Take the figure out of the scene."""
        self._root.remove()
