"""The objects around robots as data: shapes, roles, and how they are read."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from math import isfinite
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Pose
from station.core.errors import ParameterError
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
"""What an object is to the robots: a thing, a place to keep out of, the place to stay
in."""
HAND = "hand"
"""Name in `links` that stands for the hand and its fingers."""
_KEYS = {
    "name", "type", "size", "position", "rpy", "mass", "file", "friction",
    "role", "margin", "links", "colour",
}  # fmt: skip
_FRICTION = 1.0
_MARGIN = 0.02
_MOST_CORNERS = 40


@dataclass(frozen=True, slots=True)
class SceneObject:
    """An object in the world.

    Attributes:
        name: Name of the object, unique in the world.
        kind: `box`, `sphere`, `cylinder`, `capsule`, `half_space`, `mesh` or `table`. A
            table is a box whose `position` is the middle of its top; a half-space fills
            what is below its own z = 0; a mesh counts as its convex hull.
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
        colour: Red, green and blue, 0 to 255; empty for the one of its role.
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
    if not isinstance(name, str) or not name:
        _refuse(f"{where}/name", f"is {name!r}", "a name")
    if not isinstance(kind, str) or kind not in _SIZES:
        _refuse(f"{where}/type", f"is {kind!r}", f"one of {sorted(_SIZES)}")
    file = entry.get("file", "")
    if kind == "mesh" and not Path(str(file)).is_file():
        _refuse(f"{where}/file", f"is {file!r}", "the path of a mesh file")
    size = _numbers(entry.get("size", []), _SIZES[kind], f"{where}/size")
    if any(value <= 0.0 for value in size):
        _refuse(f"{where}/size", f"is {size}", "above 0")
    zeros_ = [0.0, 0.0, 0.0]
    mass = _numbers([entry.get("mass", 0.0)], 1, f"{where}/mass")[0]
    friction = _numbers([entry.get("friction", _FRICTION)], 1, f"{where}/friction")[0]
    if mass < 0.0 or friction < 0.0:
        _refuse(where, f"has mass {mass} and friction {friction}", "0 or more")
    return SceneObject(
        name=name,
        kind=kind,
        size=size,
        position=_numbers(entry.get("position", zeros_), 3, f"{where}/position"),
        rpy=_numbers(entry.get("rpy", zeros_), 3, f"{where}/rpy"),
        mass=mass,
        friction=friction,
        file=str(file),
        role=_role(entry, kind, mass, where),
        margin=_margin(entry, where),
        links=_names(entry.get("links", []), f"{where}/links"),
        colour=_colour(entry.get("colour", []), f"{where}/colour"),
    )


def _role(entry: Mapping[str, object], kind: str, mass: float, where: str) -> str:
    role = entry.get("role", "object")
    if not isinstance(role, str) or role not in ROLES:
        _refuse(f"{where}/role", f"is {role!r}", f"one of {list(ROLES)}")
    if role != "object" and mass > 0.0:
        _refuse(f"{where}/mass", f"is {mass}", f"0: a {role} stays where it is")
    if role == "object" and kind == "half_space":
        _refuse(f"{where}/role", "is 'object'", "keep_out or fence for a half-space")
    return role


def _margin(entry: Mapping[str, object], where: str) -> float:
    margin = _numbers([entry.get("margin", _MARGIN)], 1, f"{where}/margin")[0]
    if margin < 0.0:
        _refuse(f"{where}/margin", f"is {margin}", "0 or more [m]")
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
    if not all(0.0 <= one <= 255.0 for one in (red, green, blue)):
        _refuse(where, f"is {values!r}", "of numbers from 0 to 255")
    return int(red), int(green), int(blue)


def solid_of(thing: SceneObject, base: Pose, triangles: list[float]) -> list[float]:
    """Return an object as a row of `distances`, in the frame of a robot's base.

    Args:
        thing: The object.
        base: Pose of the base in the world.
        triangles: Triangles of all meshes [m]; those of this object are added.

    Raises:
        ParameterError: The file of a mesh is no STL or OBJ file with a volume.
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
    w, x, y, z = base.quaternion
    inverse = Pose((0.0, 0.0, 0.0), (w, -x, -y, -z))
    bx, by, bz = inverse.compose(Pose(base.xyz)).xyz
    pose = Pose((-bx, -by, -bz), inverse.quaternion).compose(thing.pose())
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


def mesh_vertices(path: Path) -> NDArray[np.float64]:
    """Return the corners of a mesh [m], shape (n, 3).

    Args:
        path: An OBJ file, or an STL file, binary or text.

    Raises:
        ParameterError: The file has no corners that can be read.
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
        _refuse(str(path), "has no corners that can be read", "an STL or OBJ file")
    return np.unique(corners.astype(float), axis=0)


def add_hull(vertices: NDArray[np.float64], triangles: list[float]) -> float:
    """Add the triangles of a convex hull of some points, made of a few of them.

    Args:
        vertices: The points [m], shape (n, 3).
        triangles: Where the corners go [m], 9 numbers per triangle.

    Returns:
        How far the points reach beyond these triangles [m], >= 0.

    Raises:
        ParameterError: The points lie in a plane.
    """
    # Even directions over a ball: points of the golden spiral.
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
        _refuse(
            "scene/objects",
            "has a mesh that lies in a plane",
            "of meshes with a volume",
        )
    solid[0], solid[1], solid[5], solid[9] = distances.MESH, 1.0, 1.0, 1.0
    solid[18], solid[19] = begin // 9, (len(triangles) - begin) // 9
    nearness, memory = distances.Nearness(), doubles(triangles)
    return max(
        0.0, max(nearness.of_mesh(x, y, z, solid, memory) for x, y, z in vertices)
    )


def _fan(corners: NDArray[np.float64], normal: NDArray[np.float64]) -> list[float]:
    """Return the triangles of a convex face, all turning left about its normal."""
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


def words_for_pair(link: str, thing: str, distance: float, margin: float) -> str:
    """Return a pair of a link and an object in words.

    Args:
        link: Name of the link.
        thing: Name of the object.
        distance: Distance of their surfaces [m].
        margin: Distance that was to be kept [m].
    """
    short = 1000.0 * (margin - distance)
    if distance < 0.0:
        return f"{link} would come {-1000.0 * distance:.0f} mm into '{thing}'"
    return (
        f"{link} would come within {1000.0 * distance:.0f} mm of '{thing}', "
        f"{short:.0f} mm less than its margin"
    )


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
        remedy="Correct the configuration.",
        details={"parameter": where},
    )
