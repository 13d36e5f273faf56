"""Objects of a scene as bodies of a MuJoCo world."""

import mujoco

from station.core.geometry.scene import SceneObject


def add_object(spec: mujoco.MjSpec, thing: SceneObject) -> None:
    """Add an object to the world; an object with a mass can be pushed.

    Args:
        spec: The world; changed.
        thing: The object.
    """
    if not thing.solid:
        return
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
        case "capsule":
            geom.type = mujoco.mjtGeom.mjGEOM_CAPSULE
            geom.size[:2] = [thing.size[0], thing.size[1] / 2.0]
        case "half_space":
            geom.type = mujoco.mjtGeom.mjGEOM_PLANE
            geom.size = [1.0, 1.0, 1.0]
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
