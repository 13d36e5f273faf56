"""Capsules of the guard around the collision meshes that MuJoCo has."""

from itertools import product

import mujoco
import numpy as np
import pytest

from station.hw.franka.commands.arm_guard import CAPSULES
from tests.hw.franka.guarded_motions import JOINTS, READY, Motions

PARTS = {"hand": "hand", "leftfinger": "fingers", "rightfinger": "fingers"}


@pytest.fixture(scope="module")
def motions() -> Motions:
    return Motions(scene=[])


def corners_of(model, geom: int) -> np.ndarray:
    """Return the corners of a mesh or a box in its own frame [m], shape (n, 3)."""
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX:
        signs = np.array([*product((-1.0, 1.0), repeat=3)])
        return signs * model.geom_size[geom]
    mesh = model.geom_dataid[geom]
    begin, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    return model.mesh_vert[begin : begin + count]


@pytest.mark.parametrize("opening", [0.0, 0.02, 0.04])
def test_capsules_enclose_the_links(motions, opening):
    model, data = motions.model, motions.data
    for name, value in zip(JOINTS, READY, strict=True):
        data.joint(name).qpos[0] = value
    for finger in (1, 2):
        data.joint(f"panda_finger_joint{finger}").qpos[0] = opening
    mujoco.mj_kinematics(model, data)
    random, seen = np.random.default_rng(1), set()
    for geom in range(model.ngeom):
        body = model.body(model.geom_bodyid[geom]).name.removeprefix("panda_")
        if body in {"world", "link0"} or not model.geom_contype[geom]:
            continue
        link = PARTS.get(body, body)
        seen.add(link)
        corners = corners_of(model, geom)
        # Corners, and points of their hull near its surface.
        picked = random.integers(0, len(corners), (4000, 3))
        shares = random.dirichlet(np.ones(3), 4000)
        inside = (corners[picked] * shares[..., None]).sum(axis=1)
        points = np.vstack([corners, inside]) @ data.geom_xmat[geom].reshape(3, 3).T
        points += data.geom_xpos[geom]
        frame = data.body(f"panda_{'link7' if link in PARTS.values() else link}")
        local = (points - frame.xpos) @ frame.xmat.reshape(3, 3)
        outside = np.full(len(local), np.inf)
        for one in CAPSULES:
            if one.link == link:
                first, axis = np.array(one.first), np.subtract(one.second, one.first)
                share = np.clip((local - first) @ axis / max(axis @ axis, 1e-12), 0, 1)
                gaps = np.linalg.norm(local - first - share[:, None] * axis, axis=1)
                outside = np.minimum(outside, gaps - one.radius)
        assert outside.max() <= 0.0, f"{body}: {1000.0 * outside.max():.1f} mm outside"
    assert seen == {one.link for one in CAPSULES}
