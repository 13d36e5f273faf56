"""The objects around robots as data: shapes, roles, meshes, and how they are read."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import isfinite
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Pose
from station.core.errors import ParameterError, RobotDescriptionError
from station.core.geometry import distances
from station.core.parameters import Parameters
from station.memory.doubles import doubles, zeros

_SIZES = {
    "box": 3,
    "sphere": 1,
    "cylinder": 2,
    "capsule": 2,
    "half_space": 0,
    "mesh": 0,
    "table": 3,
}
_KINDS = {
    "box": distances.BOX,
    "table": distances.BOX,
    "sphere": distances.SPHERE,
    "cylinder": distances.CYLINDER,
    "capsule": distances.CAPSULE,
    "half_space": distances.HALF_SPACE,
    "mesh": distances.MESH,
}
ROLES = ("object", "keep_out", "fence")
"""The roles of an object: a thing, a region to keep out of, the region to stay in."""
HAND = "hand"
"""Name in `links` for the hand and its fingers together."""
_KEYS = {
    "name", "type", "size", "position", "rpy", "mass", "file", "friction",
    "role", "margin", "links", "colour", "solid",
}  # fmt: skip
_FRICTION = 1.0
_MARGIN = 0.02
_FARTHEST = 1000.0  # [m]: doubles still tell micrometres apart, and MuJoCo converges
_HEAVIEST = 1e6  # [kg]
_ROUGHEST = 100.0  # friction over normal force
_MAX_BYTES = 200_000_000
# First bytes of a file that Git LFS has not fetched.
_PLACEHOLDER = b"version https://git-lfs"
_MOST_CORNERS = 40


@dataclass(frozen=True, slots=True)
class SceneObject:
    """An object in the world.

    Attributes:
        name: Name of the object, unique in the world.
        kind: `box`, `sphere`, `cylinder`, `capsule`, `half_space`, `mesh` or `table`. A
            table is a box whose `position` is the middle of its top; a half-space fills
            the space below its own z = 0; a mesh counts as its convex hull.
        size: Edges of a box or table; radius of a sphere; radius and height of a
            cylinder; radius of a capsule and length of its axis [m].
        position: Position at the start [m], shape (3,).
        rpy: Roll, pitch and yaw at the start [rad], shape (3,).
        mass: Mass [kg]; 0 for an object that cannot move.
        friction: Coefficient of sliding friction, >= 0.
        file: STL or OBJ file of a mesh; empty for other kinds.
        role: One of `ROLES`.
        margin: Distance that the robots keep from it [m], >= 0.
        links: Links that a role is for; empty for all. `hand` is the hand and its
            fingers.
        colour: Red, green and blue, 0 to 255; empty for the colour of its role.
        solid: Whether a simulated robot can touch it.
        carried_by: Name of the arm whose hand carries it; empty for none.
        grip: Pose of its middle in the arm's flange while it is carried.
    """

    name: str
    kind: str
    size: tuple[float, ...] = ()
    position: tuple[float, ...] = (0.0, 0.0, 0.0)
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)
    mass: float = 0.0
    friction: float = _FRICTION
    file: str = ""
    role: str = "object"
    margin: float = _MARGIN
    links: tuple[str, ...] = ()
    colour: tuple[int, ...] = ()
    solid: bool = True
    carried_by: str = ""
    grip: Pose = field(default_factory=Pose)

    def pose(self) -> Pose:
        """Return the pose of its middle in the world."""
        x, y, z = self.position
        if self.kind == "table":
            z -= self.size[2] / 2.0
        roll, pitch, yaw = self.rpy
        return Pose.from_rpy((x, y, z), (roll, pitch, yaw))

    def at(self, pose: Pose) -> "SceneObject":
        """Return the same object with its middle at a pose in the world."""
        x, y, z = pose.xyz
        if self.kind == "table":
            z += self.size[2] / 2.0
        return replace(self, position=(x, y, z), rpy=pose.rpy())


def read_scene(root_params: Parameters) -> list[SceneObject]:
    """Return the objects in `scene/objects` of the root namespace.

    Args:
        root_params: Parameters of the station's root namespace.

    Raises:
        ParameterError: An entry is malformed, or a name is used twice.
    """
    entries = root_params.get("scene/objects", [])
    if not isinstance(entries, list):
        _refuse("scene/objects", f"is {entries!r}", "a list")
    found = [read_object(one, f"scene/objects/{i}") for i, one in enumerate(entries)]
    names = [one.name for one in found]
    if len(set(names)) != len(names):
        _refuse("scene/objects", f"has the names {names}", "of unlike names")
    return found


def read_object(values: object, where: str) -> SceneObject:
    """Return the object that an entry of `scene/objects` describes.

    Args:
        values: The entry.
        where: Path of the entry in the configuration, for messages.

    Raises:
        ParameterError: A key is unknown, or a value is impossible.
    """
    entry = values if isinstance(values, Mapping) else {}
    unknown = sorted(set(entry) - _KEYS)
    if not entry or unknown:
        _refuse(where, f"is {values!r}", f"with keys of {sorted(_KEYS)}")
    name, kind = entry.get("name"), entry.get("type")
    # A name is one segment of an address, too.
    if (
        not isinstance(name, str)
        or not name.strip(" .")
        or not name.isprintable()
        or "/" in name
    ):
        _refuse(
            f"{where}/name",
            f"is {name!r}",
            "a name of printable characters without /, and not of dots and spaces",
        )
    if not isinstance(kind, str) or kind not in _SIZES:
        _refuse(f"{where}/type", f"is {kind!r}", f"one of {sorted(_SIZES)}")
    file = entry.get("file", "")
    if kind == "mesh":
        _check_mesh(file, f"{where}/file")
    elif file:
        _refuse(f"{where}/file", f"is {file!r}", f"left out: a {kind} has no file")
    size = _numbers(entry.get("size", []), _SIZES[kind], f"{where}/size")
    if not all(0.0 < value <= _FARTHEST for value in size):
        _refuse(f"{where}/size", f"is {size}", f"above 0, and {_FARTHEST:g} m at most")
    zeros_ = [0.0, 0.0, 0.0]
    mass = _numbers([entry.get("mass", 0.0)], 1, f"{where}/mass")[0]
    friction = _numbers([entry.get("friction", _FRICTION)], 1, f"{where}/friction")[0]
    if not 0.0 <= mass <= _HEAVIEST or not 0.0 <= friction <= _ROUGHEST:
        _refuse(
            where,
            f"has mass {mass} and friction {friction}",
            f"0 or more, {_HEAVIEST:g} kg and {_ROUGHEST:g} at most",
        )
    position = _numbers(entry.get("position", zeros_), 3, f"{where}/position")
    if any(abs(value) > _FARTHEST for value in position):
        _refuse(f"{where}/position", f"is {position}", f"within {_FARTHEST:g} m")
    return SceneObject(
        name=name,
        kind=kind,
        size=size,
        position=position,
        rpy=_numbers(entry.get("rpy", zeros_), 3, f"{where}/rpy"),
        mass=mass,
        friction=friction,
        file=str(file),
        role=_role(entry, kind, mass, where),
        margin=_margin(entry, where),
        links=_names(entry.get("links", []), f"{where}/links"),
        colour=_colour(entry.get("colour", []), f"{where}/colour"),
        solid=_solid(entry, where),
    )


def _check_mesh(file: object, where: str) -> None:
    path = Path(str(file))
    if not path.is_file():
        _refuse(where, f"is {file!r}", "the path of a mesh file")
    try:
        check_mesh_file(path)
    except RobotDescriptionError as error:
        raise ParameterError(
            f"Parameter '{where}' is {file!r}. {error.message}",
            remedy=error.remedy,
            details={"parameter": where},
        ) from error


def _role(entry: Mapping[str, object], kind: str, mass: float, where: str) -> str:
    role = entry.get("role", "object")
    if not isinstance(role, str) or role not in ROLES:
        _refuse(f"{where}/role", f"is {role!r}", f"one of {list(ROLES)}")
    if role != "object" and mass > 0.0:
        _refuse(f"{where}/mass", f"is {mass}", f"0: a {role} stays where it is")
    if role == "object" and kind == "half_space":
        _refuse(f"{where}/role", "is 'object'", "keep_out or fence for a half-space")
    return role


def _solid(entry: Mapping[str, object], where: str) -> bool:
    """Return whether robots can touch an object; by default, not a region."""
    role = entry.get("role", "object")
    solid = entry.get("solid", role == "object")
    if not isinstance(solid, bool):
        _refuse(f"{where}/solid", f"is {solid!r}", "true or false")
    if solid != (role == "object") and role != "keep_out":
        _refuse(f"{where}/solid", f"is {solid} for the role {role}", str(not solid))
    return solid


def _margin(entry: Mapping[str, object], where: str) -> float:
    margin = _numbers([entry.get("margin", _MARGIN)], 1, f"{where}/margin")[0]
    if not 0.0 <= margin <= _FARTHEST:
        _refuse(f"{where}/margin", f"is {margin}", f"0 to {_FARTHEST:g} m")
    return margin


def _names(values: object, where: str) -> tuple[str, ...]:
    if not isinstance(values, (list, tuple)) or not all(
        isinstance(one, str) and one for one in values
    ):
        _refuse(where, f"is {values!r}", "a list of names of links")
    return tuple(values)


def _colour(values: object, where: str) -> tuple[int, ...]:
    if not values:
        return ()
    red, green, blue = _numbers(values, 3, where)
    if not all(one in range(256) for one in (red, green, blue)):
        _refuse(where, f"is {values!r}", "of whole numbers from 0 to 255")
    return int(red), int(green), int(blue)


def solid_of(thing: SceneObject, base: Pose, triangles: list[float]) -> list[float]:
    """Return an object as a row of `distances`, in the frame of a robot's base.

    Args:
        thing: The object.
        base: Pose of the base in the world.
        triangles: Triangles of all meshes [m]; receives those of this object.

    Raises:
        RobotDescriptionError: The file of a mesh is not an STL or OBJ file with a
            volume.
    """
    sizes, begin = [*thing.size], len(triangles) // 9
    match thing.kind:
        case "box" | "table":
            sizes = [edge / 2.0 for edge in sizes]
        case "cylinder" | "capsule":
            sizes[1] /= 2.0
        case "mesh":
            sizes = [add_hull(mesh_vertices(Path(thing.file)), triangles)]
        case _:
            pass
    pose = base.inverse().compose(thing.pose())
    w, x, y, z = pose.quaternion
    axes = [
        1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),
        2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
        2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    sizes += [0.0] * (3 - len(sizes))
    side = -1.0 if thing.role == "fence" else 1.0
    count = len(triangles) // 9 - begin
    kind = float(_KINDS[thing.kind])
    return [kind, *axes, *pose.xyz, *sizes, thing.margin, side, begin, count]


def _numbers(values: object, count: int, where: str) -> tuple[float, ...]:
    if (
        not isinstance(values, (list, tuple))
        or len(values) != count
        or not all(
            isinstance(v, (int, float)) and not isinstance(v, bool) and isfinite(v)
            for v in values
        )
    ):
        _refuse(where, f"is {values!r}", f"{count} finite numbers")
    return tuple(float(value) for value in values)


def _refuse(where: str, found: str, wanted: str) -> NoReturn:
    raise ParameterError(
        f"'{where}' {found}; it must be {wanted}.",
        remedy="Correct the object.",
        details={"parameter": where},
    )


def check_mesh_file(path: Path) -> None:
    """Refuse a file that cannot be a mesh, before it is read.

    Args:
        path: The file.

    Raises:
        RobotDescriptionError: The file has no extension, is missing or too large, or is
            only the placeholder of a file that Git LFS has not fetched.
    """
    # Only the extension tells the readers which format to expect.
    if not path.suffix:
        raise RobotDescriptionError(
            f"The mesh file {path} has no extension, so that its format is not known.",
            remedy="Give the file the extension of its format, such as .stl or .obj.",
        )
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            begin = file.read(len(_PLACEHOLDER))
    except OSError as exc:
        raise RobotDescriptionError(
            f"The mesh file {path} cannot be read: {exc.strerror}.",
            remedy="Check the path and its permissions.",
        ) from exc
    # A larger mesh takes all memory, or minutes, before MuJoCo refuses it.
    if size > _MAX_BYTES:
        raise RobotDescriptionError(
            f"The mesh file {path} has {size} bytes; a mesh may have {_MAX_BYTES}.",
            remedy="Use a mesh of fewer triangles; only its convex hull collides.",
        )
    if begin == _PLACEHOLDER:
        raise RobotDescriptionError(
            f"The mesh file {path} is the placeholder of a large file.",
            remedy="Run 'git lfs pull' where it was checked out.",
        )


def mesh_vertices(path: Path) -> NDArray[np.float64]:
    """Return the corners of a mesh [m], shape (n, 3).

    Args:
        path: An OBJ file, or an STL file, binary or text.

    Raises:
        RobotDescriptionError: Fewer than four corners can be read from the file.
    """
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    try:
        if len(data) == 84 + 50 * count:
            rows = np.frombuffer(data, np.uint8, offset=84).reshape(count, 50)
            corners = rows[:, 12:48].copy().view("<f4").reshape(-1, 3)
        else:
            word = "v " if path.suffix.lower() == ".obj" else "vertex "
            lines = data.decode(errors="replace").splitlines()
            found = [one.split()[1:4] for one in lines if one.strip().startswith(word)]
            corners = np.array(found, dtype=float).reshape(-1, 3)
    except ValueError:
        corners = np.empty((0, 3))
    if len(corners) < 4 or not np.isfinite(corners).all():
        raise RobotDescriptionError(
            f"The mesh file {path} has no corners that can be read.",
            remedy="Give an STL or OBJ file.",
        )
    return np.unique(corners.astype(float), axis=0)


def add_hull(vertices: NDArray[np.float64], triangles: list[float]) -> float:
    """Add the triangles of a convex hull that uses only some of the given points.

    Args:
        vertices: The points [m], shape (n, 3).
        triangles: Receives the corners [m], 9 numbers per triangle.

    Returns:
        Distance by which the points reach beyond these triangles [m], >= 0.

    Raises:
        RobotDescriptionError: The points lie in a plane.
    """
    # Evenly spread directions: points of the golden spiral on a sphere.
    turn = np.arange(4 * _MOST_CORNERS) + 0.5
    polar = np.arccos(1.0 - turn / (2.0 * _MOST_CORNERS))
    around = np.pi * (1.0 + 5.0**0.5) * turn
    ways = np.stack([
        np.cos(around) * np.sin(polar), np.sin(around) * np.sin(polar), np.cos(polar),
    ])  # fmt: skip
    chosen = np.unique((vertices @ ways).argmax(axis=0))
    while len(chosen) > _MOST_CORNERS:
        chosen = chosen[:: 1 + len(chosen) // _MOST_CORNERS]
    corners, size = vertices[chosen], float(np.ptp(vertices, axis=0).max())
    begin, seen = len(triangles), set()
    for i, j, k in combinations(range(len(corners)), 3):
        normal = np.cross(corners[j] - corners[i], corners[k] - corners[i])
        area = float(np.linalg.norm(normal))
        if area < 1e-9 * size * size:
            continue
        heights = (corners - corners[i]) @ (normal / area)
        if heights.max() > 1e-7 * size:
            if heights.min() < -1e-7 * size:
                continue
            normal, heights = -normal, -heights
        face = np.flatnonzero(heights > -1e-7 * size)
        if tuple(face) not in seen:
            seen.add(tuple(face))
            triangles += _fan(corners[face], normal / area)
    solid = zeros(distances.ROW)
    if len(triangles) - begin < 36:
        raise RobotDescriptionError(
            "A mesh that a robot is to keep clear of lies in a plane.",
            remedy="Give one with a volume, or a box.",
        )
    solid[0], solid[1], solid[5], solid[9] = distances.MESH, 1.0, 1.0, 1.0
    solid[18], solid[19] = begin // 9, (len(triangles) - begin) // 9
    nearness = distances.Nearness(solid, doubles(triangles))
    return max(0.0, max(nearness.of_mesh(x, y, z, 0) for x, y, z in vertices))


def _fan(corners: NDArray[np.float64], normal: NDArray[np.float64]) -> list[float]:
    """Return triangles of a convex face, corners counter-clockwise about its normal."""
    middle = corners.mean(axis=0)
    first = corners[0] - middle
    second = np.cross(normal, first)
    angles = np.arctan2((corners - middle) @ second, (corners - middle) @ first)
    ring = corners[np.argsort(angles)]
    return [
        float(value)
        for i in range(1, len(ring) - 1)
        for corner in (ring[0], ring[i], ring[i + 1])
        for value in corner
    ]
