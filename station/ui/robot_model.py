"""Load a robot's URDF with its visual meshes, ready to be drawn."""

import importlib.metadata
import io
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from urllib.parse import unquote, urlparse
from xml.etree import ElementTree

import yourdfpy
from viser.transforms import SO3

from station.ui.joint_frames import JointFrame, Mimic, Motion, Quaternion

_SCHEME = "example-robot-data:"
_DISTRIBUTION = "example-robot-data"
_DATA_DIRECTORY = "cmeel.prefix/share/example-robot-data"
# What the libraries that read URDFs and meshes stumble over.
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
    """The robot cannot be drawn; the message says why and what to do."""


def load_robot(
    reference: str, arm_id: str = "panda", base: Sequence[float] = (0.0,) * 6
) -> yourdfpy.URDF:
    """Load a robot with its visual meshes.

    Args:
        reference: `example-robot-data:<robot>` or the path of a URDF file.
        arm_id: Takes the place of `panda` in the names of a Panda's joints and links.
        base: Where the root link stands: x, y, z [m], roll, pitch, yaw [rad].

    Returns:
        The model; its scene graph holds the visual meshes.

    Raises:
        RobotModelError: There is no such robot, or its files cannot be used.
    """
    path = _urdf_path(reference)
    try:
        xml = path.read_text(encoding="utf-8")
        if arm_id != "panda":
            xml = xml.replace('"panda_', f'"{arm_id}_')
        return yourdfpy.URDF.load(
            io.BytesIO(_with_base(xml, base)),
            filename_handler=_mesh_finder(path),
            load_collision_meshes=False,
            force_collision_mesh=False,
        )
    except LIBRARY_FAILURES as exc:
        raise RobotModelError(
            f"The robot {reference!r} cannot be drawn: {_described(exc)}. Give the "
            "path of a URDF whose meshes are at hand and in a known format."
        ) from exc


def joint_frames(urdf: yourdfpy.URDF) -> dict[str, JointFrame]:
    """Return all joints of a robot by the name of their child link."""
    return {joint.child: _joint_frame(joint) for joint in urdf.joint_map.values()}


def joint_limits(urdf: yourdfpy.URDF) -> dict[str, tuple[float, float]]:
    """Return the position limits of the moving joints by name [rad] or [m]."""
    limits = {}
    for joint in urdf.joint_map.values():
        if Motion.of_urdf_type(joint.type) is Motion.FIXED or joint.mimic is not None:
            continue
        # A continuous joint may have turned once.
        low, high = -2.0 * math.pi, 2.0 * math.pi
        if joint.type != "continuous" and joint.limit is not None:
            low = joint.limit.lower if joint.limit.lower is not None else low
            high = joint.limit.upper if joint.limit.upper is not None else high
        limits[joint.name] = (float(low), float(high))
    return limits


def base_position(urdf: yourdfpy.URDF) -> tuple[float, float, float]:
    """Return where the root link stands, x, y, z [m]."""
    for joint in urdf.joint_map.values():
        if joint.parent == urdf.base_link and joint.origin is not None:
            x, y, z = (float(value) for value in joint.origin[:3, 3])
            return x, y, z
    return 0.0, 0.0, 0.0


def _described(error: BaseException) -> str:
    return str(error) or type(error).__name__


def _joint_frame(joint: yourdfpy.Joint) -> JointFrame:
    wxyz: Quaternion = (1.0, 0.0, 0.0, 0.0)
    x, y, z = 0.0, 0.0, 0.0
    if joint.origin is not None:
        rotation = SO3.from_matrix(joint.origin[:3, :3])
        w, i, j, k = (float(value) for value in rotation.wxyz)
        wxyz = (w, i, j, k)
        x, y, z = (float(value) for value in joint.origin[:3, 3])
    axis = (1.0, 0.0, 0.0)
    if joint.axis is not None:
        # Fixed joints may have the axis 0 0 0.
        length = sum(float(part) ** 2 for part in joint.axis) ** 0.5 or 1.0
        ax, ay, az = (float(part) / length for part in joint.axis)
        axis = (ax, ay, az)
    mimic = None
    if joint.mimic is not None:
        rule = joint.mimic
        factor = 1.0 if rule.multiplier is None else float(rule.multiplier)
        mimic = Mimic(rule.joint, factor, float(rule.offset or 0.0))
    return JointFrame(
        joint.name, Motion.of_urdf_type(joint.type), axis, (x, y, z), wxyz, mimic
    )


def _with_base(xml: str, base: Sequence[float]) -> bytes:
    """Return the URDF with a new root link, on which the old one stands at `base`."""
    robot = ElementTree.fromstring(xml)
    children = {child.get("link") for child in robot.iterfind("joint/child")}
    links = [link.get("name", "") for link in robot.findall("link")]
    for name in links:
        if name not in children:
            joint = ElementTree.SubElement(
                robot, "joint", name="station_base_joint", type="fixed"
            )
            ElementTree.SubElement(joint, "parent", link="station_base")
            ElementTree.SubElement(joint, "child", link=name)
            xyz, rpy = (" ".join(map(str, part)) for part in (base[:3], base[3:]))
            ElementTree.SubElement(joint, "origin", xyz=xyz, rpy=rpy)
    ElementTree.SubElement(robot, "link", name="station_base")
    return ElementTree.tostring(robot)


def _urdf_path(reference: str) -> Path:
    if not reference.startswith(_SCHEME):
        return Path(reference).expanduser()
    name = reference.removeprefix(_SCHEME).strip()
    known = {path.stem: path for path in _data_directory().glob("robots/*/*/*.urdf")}
    path = known.get(name) or known.get(f"{name}_robot")
    if path is None:
        raise RobotModelError(
            f"{_DISTRIBUTION} has no robot {name!r}; it has {', '.join(sorted(known))}."
        )
    return path


def _data_directory() -> Path:
    try:
        distribution = importlib.metadata.distribution(_DISTRIBUTION)
    except importlib.metadata.PackageNotFoundError as exc:
        raise RobotModelError(
            f"The package {_DISTRIBUTION} is not installed; run `make setup`, or give "
            "the path of a URDF."
        ) from exc
    return Path(str(distribution.locate_file(_DATA_DIRECTORY)))


def _mesh_finder(urdf_path: Path) -> Callable[[str], str]:
    """Return what turns a mesh's URI into a file name."""

    def find(fname: str) -> str:
        parts = urlparse(fname)
        if parts.scheme in {"", "file"}:
            return str(urdf_path.parent / (parts.netloc + unquote(parts.path)))
        relative = Path(parts.netloc, unquote(parts.path).lstrip("/"))
        roots = [*urdf_path.resolve().parents]
        if parts.netloc == _DISTRIBUTION:
            roots.append(_data_directory().parent)
        for root in roots:
            if (root / relative).is_file():
                return str(root / relative)
        raise RobotModelError(f"{urdf_path}: the mesh {fname!r} was not found.")

    return find
