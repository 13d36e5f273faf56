"""Capsules and load of what a hand carries, against points and MuJoCo."""

import mujoco
import numpy as np
import pytest

from station.core.description.urdf import Pose
from station.core.errors import SceneRefusedError
from station.core.geometry.capsules import enclosing_capsules, load_of
from station.core.geometry.scene import SceneObject

GRIP = Pose.from_rpy((0.02, -0.03, 0.2), (0.3, -0.4, 0.5))
THINGS = [
    SceneObject("cube", "box", (0.05, 0.05, 0.05), mass=0.2),
    SceneObject("plate", "box", (0.3, 0.2, 0.02), mass=0.5),
    SceneObject("rod", "cylinder", (0.02, 0.3), mass=0.3),
    SceneObject("ball", "sphere", (0.06,), mass=0.4),
]
_TYPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
}


def points_of(thing: SceneObject) -> np.ndarray:
    """Return points of a surface in its own frame [m], shape (n, 3)."""
    random = np.random.default_rng(1)
    points = random.uniform(-1.0, 1.0, (2000, 3))
    if thing.kind == "box":
        return np.sign(points) * np.array(thing.size) / 2.0
    around = points / np.linalg.norm(points, axis=1)[:, None]
    if thing.kind == "sphere":
        return around * thing.size[0]
    flat = points[:, :2] / np.linalg.norm(points[:, :2], axis=1)[:, None]
    heights = 0.5 * thing.size[1] * points[:, 2:]
    return np.hstack([flat * thing.size[0], heights])


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: thing.name)
def test_capsules_enclose_what_is_carried(thing):
    least = np.full(2000, np.inf)
    points = [GRIP.compose(Pose(tuple(p.tolist()))).xyz for p in points_of(thing)]
    for one in enclosing_capsules(thing, GRIP):
        first, axis = np.array(one.first), np.subtract(one.second, one.first)
        share = np.clip((points - first) @ axis / max(axis @ axis, 1e-12), 0.0, 1.0)
        far = np.linalg.norm(points - first - share[:, None] * axis, axis=1)
        least = np.minimum(least, far - one.radius)
    assert least.max() < 1e-9


def test_load_of_two_things_is_that_of_one_body():
    other = Pose.from_rpy((-0.1, 0.05, 0.1), (0.0, 0.7, 0.0))
    held = [*((thing, GRIP) for thing in THINGS[1:]), (THINGS[0], other)]
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body()
    for thing, grip in held:
        geom = body.add_geom(type=_TYPES[thing.kind], mass=thing.mass)
        size = list(thing.size)
        if thing.kind == "box":
            size = [edge / 2.0 for edge in size]
        elif thing.kind == "cylinder":
            size[1] /= 2.0
        geom.size[: len(size)] = size
        geom.pos, geom.quat = grip.xyz, grip.quaternion
    model = spec.compile()
    mass, center, inertia = load_of(held)
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[1])
    axes = turn.reshape(3, 3)
    assert mass == pytest.approx(model.body_mass[1])
    assert center == pytest.approx(model.body_ipos[1].tolist())
    expected = axes @ np.diag(model.body_inertia[1]) @ axes.T
    assert np.array(inertia) == pytest.approx(expected.ravel(), abs=1e-9)


def test_a_half_space_is_not_carried():
    with pytest.raises(SceneRefusedError, match="no hand carries"):
        enclosing_capsules(SceneObject("ground", "half_space"), GRIP)
