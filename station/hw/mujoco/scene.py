"""The objects in the world besides robots: boxes, spheres, a table, a mesh."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import NoReturn

import mujoco

from station.core.description.urdf import Pose
from station.core.errors import ParameterError, RobotDescriptionError
from station.core.parameters import Parameters
from station.hw.mujoco.mesh_loader import check_mesh_file

_SIZES = {"box": 3, "sphere": 1, "cylinder": 2, "mesh": 0, "table": 3}
_KEYS = {"name", "type", "size", "position", "rpy", "mass", "file", "friction"}
_FRICTION = 1.0


@dataclass(frozen=True, slots=True)
class SceneObject:
    """An object in the world.

    Attributes:
        name: Name of the object, unique in the world.
        kind: `box`, `sphere`, `cylinder`, `table` or `mesh`. A table is a box whose
            `position` is the middle of its top.
        size: Edges of a box or table; radius of a sphere; radius and height of a
            cylinder [m].
        position: Position at the start [m], shape (3,).
        rpy: Roll, pitch and yaw at the start [rad], shape (3,).
        mass: Mass [kg]; 0 for an object that cannot move.
        friction: Coefficient of sliding friction, >= 0.
        file: STL or OBJ file of a mesh; empty for other kinds.
    """

    name: str
    kind: str
    size: tuple[float, ...] = ()
    position: tuple[float, ...] = (0.0, 0.0, 0.0)
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)
    mass: float = 0.0
    friction: float = _FRICTION
    file: str = ""


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
    if kind == "mesh":
        _check_mesh(file, f"{where}/file")
    size = _numbers(entry.get("size", []), _SIZES[kind], f"{where}/size")
    if any(value <= 0.0 for value in size):
        _refuse(f"{where}/size", f"is {size}", "above 0")
    zeros = [0.0, 0.0, 0.0]
    mass = _numbers([entry.get("mass", 0.0)], 1, f"{where}/mass")[0]
    friction = _numbers([entry.get("friction", _FRICTION)], 1, f"{where}/friction")[0]
    if mass < 0.0 or friction < 0.0:
        _refuse(where, f"has mass {mass} and friction {friction}", "0 or more")
    return SceneObject(
        name=name,
        kind=kind,
        size=size,
        position=_numbers(entry.get("position", zeros), 3, f"{where}/position"),
        rpy=_numbers(entry.get("rpy", zeros), 3, f"{where}/rpy"),
        mass=mass,
        friction=friction,
        file=str(file),
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


def add_object(spec: mujoco.MjSpec, thing: SceneObject) -> None:
    """Put an object into the world; an object with a mass can be pushed.

    Args:
        spec: The world; changed.
        thing: The object.
    """
    position = list(thing.position)
    if thing.kind == "table":
        position[2] -= thing.size[2] / 2.0
    roll, pitch, yaw = thing.rpy
    turned = Pose.from_rpy((0.0, 0.0, 0.0), (roll, pitch, yaw)).quaternion
    body = spec.worldbody.add_body(name=thing.name, pos=position, quat=turned)
    geom = body.add_geom(name=thing.name)
    geom.friction[0] = thing.friction
    match thing.kind:
        case "sphere":
            geom.type = mujoco.mjtGeom.mjGEOM_SPHERE
            geom.size[0] = thing.size[0]
        case "cylinder":
            geom.type = mujoco.mjtGeom.mjGEOM_CYLINDER
            geom.size[:2] = [thing.size[0], thing.size[1] / 2.0]
        case "mesh":
            geom.type = mujoco.mjtGeom.mjGEOM_MESH
            geom.meshname = thing.name
            spec.add_mesh(name=thing.name, file=thing.file, info=thing.file)
        case _:
            geom.type = mujoco.mjtGeom.mjGEOM_BOX
            geom.size = [edge / 2.0 for edge in thing.size]
    if thing.mass > 0.0:
        geom.mass = thing.mass
        body.add_freejoint(name=thing.name)


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
