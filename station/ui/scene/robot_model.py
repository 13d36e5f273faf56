"""Load a robot's URDF with visual meshes and collision geometry, ready to be drawn.

`station.core.description` reads how the joints are connected and how they move;
yourdfpy loads and places the visual meshes. The collision geometry becomes surfaces.
"""

import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import trimesh
import viser
import yourdfpy
from numpy.typing import NDArray

from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.description.urdf import JointType, Pose, Shape, Urdf, Vector3
from station.core.description.urdf_parser import parse_urdf
from station.core.description.urdf_repair import repair_urdf
from station.core.errors import RobotDescriptionError
from station.ui.scene.joint_frames import is_drawn_moving, link_poses
from station.wire import MovingBase

BASE_LINK = "station_base"
"""Name of the link to which the root link of a robot is joined; it never moves."""
_STEPS = (
    ("x", "prismatic", "1 0 0"),
    ("y", "prismatic", "0 1 0"),
    ("z", "prismatic", "0 0 1"),
    ("yaw", "continuous", "0 0 1"),
    ("pitch", "continuous", "0 1 0"),
    ("roll", "continuous", "1 0 0"),
)


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A surface of triangles.

    Attributes:
        vertices: Their corners [m], shape (n, 3).
        faces: Three indices of corners for each triangle, shape (m, 3).
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]

    def draw(
        self,
        scene: viser.SceneApi,
        path: str,
        colour: tuple[int, int, int],
        opacity: float,
        *,
        scale: float = 1.0,
        is_flat: bool = True,
    ) -> viser.MeshHandle:
        """Draw the surface, translucent.

        Args:
            scene: Scene that shows it.
            path: Its scene node.
            colour: Its colour.
            opacity: 0 to 1.
            scale: Its size over its real size.
            is_flat: Whether each triangle is of one shade.
        """
        # Without shadows, which would draw the surface four times.
        return scene.add_mesh_simple(
            path,
            self.vertices,
            self.faces,
            color=colour,
            opacity=opacity,
            scale=scale,
            flat_shading=is_flat,
            cast_shadow=False,
            receive_shadow=False,
        )


def link_surfaces(
    urdf: Urdf, resolve_mesh: Callable[[str], Path]
) -> dict[str, Surface]:
    """Return the collision geometry of each link that has some, in the link's frame.

    Args:
        urdf: The robot.
        resolve_mesh: Returns the file of a mesh.

    Raises:
        ValueError: A mesh is in no known format.
        OSError: A mesh cannot be read.
    """
    return {
        link.name: _joined([_drawn(shape, resolve_mesh) for shape in link.collisions])
        for link in urdf.links.values()
        if link.collisions
    }


def bounds_of(
    surfaces: Mapping[str, Surface], poses: Mapping[str, Pose]
) -> NDArray[np.float64] | None:
    """Return the smallest box around a robot.

    Args:
        surfaces: Surfaces by link.
        poses: Pose of each of these links.

    Returns:
        Lowest and highest corner [m], shape (2, 3); None without any surface.
    """
    if not surfaces:
        return None
    points = np.concatenate([
        placed(surface.vertices, poses[link]) for link, surface in surfaces.items()
    ])
    return np.stack([points.min(axis=0), points.max(axis=0)])


def placed(points: NDArray[np.floating], pose: Pose) -> NDArray[np.float64]:
    """Return points of a frame in its parent.

    Args:
        points: Points [m], shape (n, 3).
        pose: The frame in its parent.
    """
    w, x, y, z = pose.quaternion
    axis = np.array([x, y, z])
    # v + 2 w (a x v) + 2 a x (a x v) turns v by a unit quaternion (w, a).
    turn = 2.0 * np.cross(axis, points)
    moved: NDArray[np.float64] = points + w * turn + np.cross(axis, turn) + pose.xyz
    return moved


def _drawn(shape: Shape, resolve_mesh: Callable[[str], Path]) -> Surface:
    scale = (1.0, 1.0, 1.0)
    match shape.kind:
        case "box":
            mesh = trimesh.creation.box(extents=shape.size)
        case "sphere":
            mesh = trimesh.creation.icosphere(subdivisions=2, radius=shape.size[0])
        case "cylinder":
            radius, height = shape.size
            mesh = trimesh.creation.cylinder(radius=radius, height=height, sections=24)
        case _:
            mesh = trimesh.load_mesh(str(resolve_mesh(str(shape.mesh))))
            scale = (shape.size[0], shape.size[1], shape.size[2])
    vertices = placed(np.asarray(mesh.vertices) * scale, shape.origin)
    faces = np.asarray(mesh.faces, dtype=np.uint32)
    # A mirrored surface would show its inner side.
    is_mirrored = float(np.prod(scale)) < 0.0
    return Surface(
        vertices.astype(np.float32), faces[:, ::-1] if is_mirrored else faces
    )


def _joined(parts: list[Surface]) -> Surface:
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Surface(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([
            part.faces + start for part, start in zip(parts, first, strict=False)
        ]).astype(np.uint32),
    )


def carry(robot: ElementTree.Element, root: str) -> None:
    """Let a chain of joints carry the root link of a robot.

    Args:
        robot: The robot's URDF; changed.
        root: Its root link.
    """
    parent = BASE_LINK
    ElementTree.SubElement(robot, "link", name=parent)
    for i, (step, kind, axis) in enumerate(_STEPS, start=1):
        name = _joint(step)
        child = f"{name}_link" if i < len(_STEPS) else root
        joint = ElementTree.SubElement(robot, "joint", name=name, type=kind)
        ElementTree.SubElement(joint, "parent", link=parent)
        ElementTree.SubElement(joint, "child", link=child)
        ElementTree.SubElement(joint, "axis", xyz=axis)
        if kind == "prismatic":
            bounds = {"lower": "-1e6", "upper": "1e6", "effort": "0", "velocity": "0"}
            ElementTree.SubElement(joint, "limit", bounds)
        if child != root:
            ElementTree.SubElement(robot, "link", name=child)
        parent = child


def base_positions(base: MovingBase) -> dict[str, float]:
    """Return the positions of the joints that `carry` adds.

    Args:
        base: Pose of the root link.

    Returns:
        By name [m] or [rad]; empty while a reading is not finite. The angles are yaw,
        pitch and roll of the rotation Rz(yaw) Ry(pitch) Rx(roll).
    """
    values = [v for v in (*base.position, *base.orientation) if v is not None]
    if len(values) < 7:
        return {}
    *place, x, y, z, w = values
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    pitch = math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    names = (_joint(step) for step, _, _ in _STEPS)
    return dict(zip(names, (*place, yaw, pitch, roll), strict=True))


def _joint(step: str) -> str:
    return f"{BASE_LINK}_{step}"


# The exceptions of the libraries that read URDFs and meshes.
LIBRARY_FAILURES = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    ImportError,
    LookupError,
    OSError,
    RuntimeError,
    SyntaxError,
    TypeError,
    ValueError,
)


class RobotModelError(Exception):
    """The robot cannot be drawn; the message has the reason and the remedy."""


@dataclass(frozen=True, slots=True)
class RobotModel:
    """A robot that can be drawn.

    Attributes:
        urdf: Links and joints; the root link is fixed to the link `station_base`.
        drawing: The same robot with its visual meshes in a scene graph.
        surfaces: Collision geometry by link.
        arm_id: Prefix of a Panda's joints, by which the station calls the arm.
        root: The robot's own root link.
        moves: Whether that link moves in the world.
    """

    urdf: Urdf
    drawing: yourdfpy.URDF
    surfaces: Mapping[str, Surface] = field(default_factory=dict)
    arm_id: str = ""
    root: str = ""
    moves: bool = False

    def triangles(self) -> int:
        """Return the number of triangles of the visual meshes."""
        return sum(len(mesh.faces) for mesh in self.drawing.scene.geometry.values())

    def joint_limits(self) -> dict[str, tuple[float, float]]:
        """Return the position limits of the joints that are not mimic joints.

        Returns:
            Lower and upper limit by name [rad] or [m]. A joint without limits gets one
            turn in each direction.
        """
        limits = {}
        for joint in self.urdf.joints.values():
            if not is_drawn_moving(joint) or joint.mimic is not None:
                continue
            if joint.name.startswith(BASE_LINK):
                continue
            low, high = -2.0 * math.pi, 2.0 * math.pi
            if joint.limit is not None and joint.limit.lower is not None:
                low = joint.limit.lower
            if joint.limit is not None and joint.limit.upper is not None:
                high = joint.limit.upper
            limits[joint.name] = (low, high)
        return limits

    def sliding_joints(self) -> set[str]:
        """Return the joints of the robot whose positions are lengths."""
        return {
            joint.name
            for joint in self.urdf.joints.values()
            if joint.type is JointType.PRISMATIC
        }

    def bounds(self, positions: Mapping[str, float]) -> NDArray[np.float64]:
        """Return the smallest box around the robot's collision geometry.

        Args:
            positions: Joint positions by name [rad] or [m]; zero where there is none.

        Returns:
            Lowest and highest corner [m], shape (2, 3); around the frames of the links
            when the robot has no collision geometry.
        """
        poses = link_poses(self.urdf, positions)
        corners = bounds_of(self.surfaces, poses)
        if corners is None:
            origins = np.array([pose.xyz for pose in poses.values()])
            corners = np.stack([origins.min(axis=0), origins.max(axis=0)])
        return corners

    def base_position(self) -> Vector3:
        """Return the position of the robot's root link, x, y, z [m]."""
        return self.urdf.joints_below(self.urdf.root)[0].origin.xyz


def load_robot(
    reference: str,
    arm_id: str = "panda",
    base: Sequence[float] = (0.0,) * 6,
    *,
    moves: bool = False,
) -> RobotModel:
    """Load a robot with its visual meshes.

    Args:
        reference: `example-robot-data:<robot>` or the path of a URDF file.
        arm_id: Replaces `panda` in the names of a Panda's joints and links.
        base: Pose of the root link: x, y, z [m], roll, pitch, yaw [rad].
        moves: Whether the root link moves in the world. Its pose then follows from
            `base_positions`, and `base` is not used.

    Returns:
        The robot with its meshes.

    Raises:
        RobotModelError: There is no such robot, or its files cannot be used.
    """
    try:
        files = load_robot_files(reference).with_prefix("panda_", f"{arm_id}_")
        # As the simulation reads it; see station.hw.mujoco.description_repair.
        files = replace(files, xml=repair_urdf(files.xml)[0])
        urdf = parse_urdf(files.xml, source=str(files.urdf_path))
        xml = _with_base(files.xml, urdf.root, base, moves=moves)
        return RobotModel(
            parse_urdf(xml),
            _load_drawing(files, xml),
            link_surfaces(urdf, files.resolve_mesh),
            arm_id,
            urdf.root,
            moves,
        )
    except RobotDescriptionError as exc:
        raise RobotModelError(
            f"The robot '{reference}' cannot be drawn: {exc.message} {exc.remedy}"
        ) from exc
    except LIBRARY_FAILURES as exc:
        raise RobotModelError(
            f"The robot '{reference}' cannot be drawn: {_described(exc)}. Give the "
            "path of a URDF whose meshes are at hand and in a known format."
        ) from exc


def _load_drawing(files: RobotFiles, xml: str) -> yourdfpy.URDF:
    def find(fname: str) -> str:
        return str(files.resolve_mesh(fname))

    return yourdfpy.URDF.load(
        io.BytesIO(xml.encode()),
        filename_handler=find,
        load_collision_meshes=False,
        force_collision_mesh=False,
    )


def _described(error: BaseException) -> str:
    return str(error) or type(error).__name__


def _with_base(xml: str, root: str, base: Sequence[float], *, moves: bool) -> str:
    """Return the URDF with a new root link; the old one is at `base`, or moves."""
    robot = ElementTree.fromstring(xml)
    if moves:
        carry(robot, root)
        return ElementTree.tostring(robot, encoding="unicode")
    joint = ElementTree.SubElement(
        robot, "joint", name=f"{BASE_LINK}_joint", type="fixed"
    )
    ElementTree.SubElement(joint, "parent", link=BASE_LINK)
    ElementTree.SubElement(joint, "child", link=root)
    xyz, rpy = (" ".join(map(str, part)) for part in (base[:3], base[3:]))
    ElementTree.SubElement(joint, "origin", xyz=xyz, rpy=rpy)
    ElementTree.SubElement(robot, "link", name=BASE_LINK)
    return ElementTree.tostring(robot, encoding="unicode")
