"""How deep the bodies of a world are in its floor."""

from math import inf, sqrt

import mujoco
import numpy as np

_FLOOR = "floor"


def depth_in_floor(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Return how deep the lowest body in the floor is in it; 0 if none is [m].

    Bodies that cannot move do not count: nothing pushes them out of the floor.

    Args:
        model: The world's model.
        data: The world's data, with the contacts of its present pose.
    """
    floor = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, _FLOOR)
    lowest = 0.0
    for number in range(int(data.ncon)):
        geoms = [int(geom) for geom in data.contact[number].geom]
        if floor not in geoms:
            continue
        (geom,) = (geom for geom in geoms if geom != floor)
        # Objects of the scene have no group of their own.
        if model.geom_group[geom]:
            lowest = min(lowest, _lowest_point(model, data, geom))
    return -lowest


def _lowest_point(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Return the height of a geometry's lowest point [m]."""
    height = float(data.geom_xpos[geom][2])
    row = data.geom_xmat[geom].reshape(3, 3)[2]
    size = model.geom_size[geom]
    match mujoco.mjtGeom(int(model.geom_type[geom])):
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return height - float(size[0])
        case mujoco.mjtGeom.mjGEOM_BOX:
            return height - float(np.abs(row) @ size)
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            across = sqrt(max(0.0, 1.0 - float(row[2]) ** 2))
            return height - float(size[0]) * across - float(size[1] * abs(row[2]))
        case mujoco.mjtGeom.mjGEOM_MESH:
            mesh = int(model.geom_dataid[geom])
            first = int(model.mesh_vertadr[mesh])
            points = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])]
            return height + float((points @ row).min())
    return inf
