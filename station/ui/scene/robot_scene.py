"""Draw a robot once, then move the drawn robot, or a figure of it, by its joint frames.

A figure is translucent: the robot at a commanded or planned pose.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import trimesh
import viser
from numpy.typing import NDArray
from trimesh.scene.transforms import SceneGraph

from station.ui.scene.camera import corners_of, fitting_distance
from station.ui.scene.joint_frames import (
    MovingFrame,
    MovingFrames,
    Place,
    is_drawn_moving,
    link_path,
)
from station.ui.scene.robot_model import LIBRARY_FAILURES, RobotModel, RobotModelError

_STAND = "_stand"
_FIELD_OF_VIEW = 0.7  # [rad], vertical
# Direction from the robot to the camera: to the right, in front and above.
_FROM = np.array([0.76, -0.58, 0.293])
Colour = tuple[int, int, int]


_FROM /= np.linalg.norm(_FROM)
# Distance of the camera over the least one from which all robots can be seen; an arm
# that moves shall stay in the picture.
_ROOM_AROUND = 1.35
_ASPECT = 1.35
"""Width over height of a picture of unknown size; few browsers show less."""
_LEAST_STAND = 0.05  # [m]


class RobotScene:
    """A robot in a Viser scene. To be used from Viser's event loop only.

    The camera looks at the place of the robot in the first call of `show`.

    Args:
        server: The scene's server.
        robot: The robot, with its visual meshes.
        root: Name of its scene node.
        beside: Robots that other objects of this class draw; the camera sees them too.
        has_camera: Whether this robot places the camera; one of several robots does.

    Attributes:
        base: Scene node of the robot's first link.
        moving: The frames that its joints move.

    Raises:
        RobotModelError: A mesh of the robot cannot be drawn.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        robot: RobotModel,
        *,
        root: str = "/robot",
        beside: Sequence[RobotModel] = (),
        has_camera: bool = True,
    ) -> None:
        self._server = server
        self._root = root
        self._beside = tuple(beside)
        self._has_camera = has_camera
        # The camera needs the meshes until the first pose is known; they are large.
        self._robot: RobotModel | None = robot
        if has_camera:
            prepare_room(server)
        try:
            self.moving = MovingFrames(server, _draw(server, robot, root))
            self._look_at({})
        except LIBRARY_FAILURES as exc:
            raise RobotModelError(
                f"The robot cannot be drawn: {type(exc).__name__}: {exc}. Its meshes "
                "must be surfaces of triangles."
            ) from exc
        self.base = _node_name(robot.drawing.scene.graph, robot.root, root)

    def show(self, positions: Mapping[str, float]) -> None:
        """Move the robot's joints.

        Args:
            positions: Joint positions by name [rad] or [m]; a joint without a position
                stays as it is, and unknown names are skipped.
        """
        if positions and self._robot is not None:
            self._look_at(positions)
            self._robot = None
            self._beside = ()
        self.moving.show(positions)

    def _look_at(self, positions: Mapping[str, float]) -> None:
        """Let the camera see the whole robot, and put a stand under its base."""
        if self._robot is None:
            return
        bounds = _box_around(self._robot, positions)
        if bounds is None:
            return
        if positions:
            base = self._robot.base_position()
            _draw_stand(self._server, self._root, base, float(bounds[0, 2]))
        if not self._has_camera:
            return
        boxes = [bounds, *(_box_around(other, positions) for other in self._beside)]
        corners = corners_of([box for box in boxes if box is not None])
        camera = self._server.initial_camera
        centre = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
        distance = _ROOM_AROUND * fitting_distance(
            corners, centre, _FROM, field_of_view=_FIELD_OF_VIEW, aspect=_ASPECT
        )
        camera.position = tuple((centre + distance * _FROM).tolist())
        camera.look_at = tuple(centre.tolist())


def _box_around(
    robot: RobotModel, positions: Mapping[str, float]
) -> NDArray[np.float64] | None:
    """Return the box around a robot's meshes, shape (2, 3); None without meshes."""
    drawing = robot.drawing
    movable = drawing.actuated_joint_names
    drawing.update_cfg({n: q for n, q in positions.items() if n in movable})
    bounds: NDArray[np.float64] | None = drawing.scene.bounds
    return bounds


def prepare_room(server: viser.ViserServer) -> None:
    """Set the floor, the light and the camera's lens, also where no robot is drawn."""
    server.scene.add_grid(
        "/floor",
        width=6.0,
        height=6.0,
        cell_size=0.1,
        section_size=1.0,
        cell_color=(150, 160, 172),
        section_color=(105, 118, 133),
        cell_thickness=0.6,
        section_thickness=1.0,
        fade_distance=9.0,
    )
    server.scene.add_frame(
        "/base_axes", axes_length=0.15, axes_radius=0.004, origin_radius=0.006
    )
    # Shadows draw the meshes four times. Without a GPU that takes so much time that a
    # browser on the station's own machine would delay the control loop.
    server.scene.configure_default_lights(cast_shadow=False)
    server.initial_camera.fov = _FIELD_OF_VIEW


def _draw_stand(
    server: viser.ViserServer,
    root: str,
    base: tuple[float, float, float],
    lowest: float,
) -> None:
    """Draw a column under a raised base, unless the robot hangs down from its base.

    Args:
        server: The scene's server.
        root: Name of the robot's scene node.
        base: Position of the root link, x, y, z [m].
        lowest: The robot's lowest point above the floor [m].
    """
    x, y, height = base
    if height < _LEAST_STAND or lowest < height - _LEAST_STAND:
        return
    for name, radius, thickness, middle in (
        ("column", 0.05, height - 0.02, height / 2.0),
        ("foot", 0.16, 0.02, 0.01),
        ("top", 0.1, 0.02, height - 0.01),
    ):
        server.scene.add_cylinder(
            f"{root}{_STAND}/{name}",
            radius=radius,
            height=thickness,
            color=(128, 138, 150),
            position=(x, y, middle),
        )


def _draw(server: viser.ViserServer, robot: RobotModel, root: str) -> list[MovingFrame]:
    scene = robot.drawing.scene
    graph = scene.graph
    server.scene.add_frame(root, show_axes=False)
    moving = []
    for joint in robot.urdf.joints.values():
        handle = server.scene.add_frame(
            _node_name(graph, joint.child, root),
            show_axes=False,
            wxyz=joint.origin.quaternion,
            position=joint.origin.xyz,
        )
        if is_drawn_moving(joint):
            moving.append(MovingFrame(joint, handle))
    for name, mesh in scene.geometry.items():
        color_by_vertices(mesh)  # before the copy, which asks for these colours
        drawn = mesh.copy()
        # Applied to the mesh, because a Viser frame cannot scale or mirror.
        drawn.apply_transform(robot.drawing.get_transform(name, _parent(graph, name)))
        server.scene.add_mesh_trimesh(_node_name(graph, name, root), drawn)
    return moving


def _parent(graph: SceneGraph, name: str) -> str:
    return str(graph.transforms.parents[name])


def _node_name(graph: SceneGraph, name: str, root: str) -> str:
    """Return the path of a frame, so that Viser nests the frames as the robot does."""
    path = [name]
    while path[-1] != graph.base_frame:
        path.append(_parent(graph, path[-1]))
    return "/".join([root, *reversed(path[:-1])])


def color_by_vertices(mesh: trimesh.Trimesh) -> None:
    """Replace colours of the faces by colours of the vertices.

    trimesh does the same when it copies or writes a mesh, but loads SciPy (113 MB) to
    compute a mean.

    Args:
        mesh: Changed when its faces have colours; a vertex gets the mean colour of the
            faces around it, and opaque grey without any.
    """
    visual = mesh.visual
    if not isinstance(visual, trimesh.visual.ColorVisuals) or visual.kind != "face":
        return
    sums = np.zeros((len(mesh.vertices), 4))
    counts = np.zeros((len(mesh.vertices), 1))
    for corner in mesh.faces.T:  # (faces,)
        np.add.at(sums, corner, visual.face_colors)
        np.add.at(counts, corner, 1.0)
    grey = trimesh.visual.color.DEFAULT_COLOR
    colors = np.where(counts > 0.0, sums / np.maximum(counts, 1.0), grey)
    colors = colors.round().astype(np.uint8)
    mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=colors)


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
