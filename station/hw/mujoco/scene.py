"""Objects of a scene as bodies of a MuJoCo world."""

from pathlib import Path

import mujoco

from station.core.errors import ParameterError, RobotDescriptionError
from station.core.geometry.scene import SceneObject
from station.hw.mujoco.mesh_loader import check_mesh_file


def add_object(spec: mujoco.MjSpec, thing: SceneObject) -> None:
    """Put an object into the world; an object with a mass can be pushed.

    Args:
        spec: The world; changed.
        thing: The object.

    Raises:
        ParameterError: The file of a mesh cannot be used.
    """
    if thing.kind == "mesh":
        _check_mesh(thing)
    pose = thing.pose()
    body = spec.worldbody.add_body(
        name=thing.name, pos=[*pose.xyz], quat=pose.quaternion
    )
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


def _check_mesh(thing: SceneObject) -> None:
    try:
        check_mesh_file(Path(thing.file))
    except RobotDescriptionError as error:
        raise ParameterError(
            f"The object '{thing.name}' has the file {thing.file!r}. {error.message}",
            remedy=error.remedy,
            details={"parameter": f"scene/objects/{thing.name}/file"},
        ) from error
