"""Distances against MuJoCo's, against a fine search, and in both modes."""

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st

from station.core.description.urdf import Pose
from station.core.geometry.distances import Nearness, nearest_points
from station.core.geometry.scene import SceneObject, solid_of
from station.memory.doubles import doubles, zeros
from tests.both_modes import assert_same, needs_both

coordinates = st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6)
SHAPES = [
    ("sphere", (0.2,)),
    ("capsule", (0.1, 0.3)),
    ("cylinder", (0.2, 0.3)),
    ("box", (0.2, 0.3, 0.4)),
    ("half_space", ()),
    ("mesh", ()),
]


def wedge(tmp_path):
    path = tmp_path / "wedge.obj"
    corners = [(0, 0, 0), (0.3, 0, 0), (0, 0.2, 0), (0, 0, 0.4), (0.3, 0, 0.1)]
    path.write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 5 4\nf 2 3 5\nf 3 4 5\n"
    )
    return path


def judged_by_mujoco(thing: SceneObject, ends, radius: float) -> float:
    kinds = mujoco.mjtGeom
    kind = {
        "sphere": kinds.mjGEOM_SPHERE,
        "capsule": kinds.mjGEOM_CAPSULE,
        "cylinder": kinds.mjGEOM_CYLINDER,
        "box": kinds.mjGEOM_BOX,
        "half_space": kinds.mjGEOM_PLANE,
        "mesh": kinds.mjGEOM_MESH,
    }[thing.kind]
    spec, pose = mujoco.MjSpec(), thing.pose()
    solid = spec.worldbody.add_geom(type=kind, pos=pose.xyz, quat=pose.quaternion)
    halves = [size / 2.0 for size in thing.size]
    if thing.kind in {"cylinder", "capsule", "sphere"}:
        halves[0] *= 2.0
    solid.size[: len(halves)] = halves
    if thing.kind == "half_space":
        solid.size = [1.0, 1.0, 1.0]
    if thing.kind == "mesh":
        spec.add_mesh(name="mesh", file=thing.file)
        solid.meshname = "mesh"
    body = spec.worldbody.add_body(mocap=True)
    body.add_geom(type=kinds.mjGEOM_CAPSULE, fromto=ends, size=[radius, 0, 0])
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return mujoco.mj_geomDistance(model, data, 0, 1, 10.0, None)


@pytest.mark.parametrize(("kind", "size"), SHAPES)
def test_distances_are_those_of_mujoco(kind, size, tmp_path):
    random = np.random.default_rng(4)
    file = str(wedge(tmp_path)) if kind == "mesh" else ""
    for _ in range(40):
        position, rpy = random.uniform(-0.5, 0.5, 3), random.uniform(-3, 3, 3)
        thing = SceneObject(kind=kind, name="it", size=size, file=file)
        thing = thing.at(Pose.from_rpy(tuple(position), tuple(rpy)))
        ends, radius = random.uniform(-0.7, 0.7, 6), 0.05
        triangles = []
        solid = doubles(solid_of(thing, Pose(), triangles))
        nearness = Nearness(solid, doubles(triangles))
        found = nearness.to_row(doubles(ends), 0, radius, 0)
        # Deep inside MuJoCo measures the shortest way out of the pair of shapes.
        if found > -0.04:
            expected = judged_by_mujoco(thing, [*ends], radius)
            # MuJoCo's search ends within 1e-6; a mesh gets 1e-6 of inflation at most.
            assert found == pytest.approx(expected, abs=2e-5)


@pytest.mark.parametrize(("kind", "size"), SHAPES)
def test_the_normal_is_the_derivative_of_the_distance(kind, size, tmp_path):
    random = np.random.default_rng(5)
    file = str(wedge(tmp_path)) if kind == "mesh" else ""
    thing = SceneObject("it", kind, size, (0.1, 0.2, 0.0), (0.3, 0.2, 0.1), file=file)
    triangles = []
    solid = doubles(solid_of(thing, Pose(), triangles))
    nearness = Nearness(solid, doubles(triangles))
    for _ in range(20):
        ends = random.uniform(-0.7, 0.7, 6)
        # An axis that crosses the surface may be led out more ways than one.
        if nearness.to_row(doubles(ends), 0, 0.0, 0) <= 0.0:
            continue
        normal = np.array(nearness.normal)
        for axis in np.eye(3):
            low, high = (
                nearness.to_row(doubles(ends + np.tile(step * axis, 2)), 0, 0.0, 0)
                for step in (-1e-5, 1e-5)
            )
            assert (high - low) / 2e-5 == pytest.approx(normal @ axis, abs=2e-3)


def test_a_fence_measures_the_farthest_end_to_its_wall():
    fence = SceneObject("room", "box", (2.0, 2.0, 2.0), role="fence")
    ends = doubles([0.0, 0.0, 0.0, 0.7, 0.0, 0.0])
    nearness = Nearness(doubles(solid_of(fence, Pose(), [])), zeros(9))

    assert nearness.to_row(ends, 0, 0.1, 0) == pytest.approx(0.2)
    assert [*nearness.normal] == pytest.approx([-1.0, 0.0, 0.0])
    assert [*nearness.point] == pytest.approx([0.7, 0.0, 0.0])


@settings(max_examples=50)
@given(coordinates, coordinates)
def test_no_points_of_two_segments_are_closer_than_their_distance(first, second):
    for ends in (first, second):
        assume(np.linalg.norm(np.subtract(ends[:3], ends[3:])) > 0.05)
    found = nearest_points(doubles(first), doubles(second), zeros(3), zeros(3))
    along = np.linspace(0.0, 1.0, 201)[:, None]
    a, b = (
        np.array(ends[:3]) * (1.0 - along) + np.array(ends[3:]) * along
        for ends in (first, second)
    )
    closest = np.linalg.norm(a[:, None] - b[None], axis=2).min()

    # The points compared are at most sqrt(12) / 200 apart on each segment. The nearest
    # points of nearly parallel segments are known to some micrometres.
    assert closest - 0.018 <= found <= closest + 1e-5


@needs_both
@settings(max_examples=60)
@given(coordinates, st.integers(0, 4), st.sampled_from([1.0, -1.0]), coordinates)
def test_both_modes_agree_bit_for_bit(ends, kind, side, other):
    solid = [float(kind), 1, 0, 0, 0, 0, 1, 0, -1, 0, 0.1, 0.2, 0.3]
    solid += [0.2, 0.3, 0.1, 0.0, side, 0.0, 0.0]

    def scenario(module):
        nearness = module.Nearness(doubles(solid), zeros(9))
        nearness.to_row(doubles(ends), 0, 0.1, 0)
        found = [nearness.distance, *nearness.point, *nearness.normal]
        point, normal = zeros(3), zeros(3)
        found.append(
            module.nearest_points(doubles(ends), doubles(other), point, normal)
        )
        return [*found, *point, *normal]

    assert_same("distances", scenario)
