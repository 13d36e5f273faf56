"""URDFs become MuJoCo models with the right kinematics, dynamics and contacts."""

from math import pi
from pathlib import Path

import mujoco
import numpy as np
import pytest

from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.description.srdf import disabled_collisions
from station.core.description.urdf import Pose, Urdf
from station.core.errors import ParameterError, RobotDescriptionError
from station.core.geometry.scene import read_object, read_scene
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.model_builder import (
    RobotOptions,
    add_object,
    add_robot,
    compile_world,
    new_world,
)
from station.hw.urdf_loader import load_urdf

ARM = [f"panda_joint{number}" for number in range(1, 8)]
START = [0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4]
# The franka model's reference pose of the flange and its pose in the base frame, from
# the arm's published modified DH parameters.
Q_REFERENCE = [
    0.5157262388785411,
    1.2140897359597562,
    1.5346381355065786,
    -3.0398301021734246,
    -1.2930720893855998,
    1.332867311125138,
    -1.5554459725458225,
]
FLANGE_REFERENCE = [
    [0.281895, -0.741623, 0.608712, -0.144822],
    [-0.927236, -0.373590, -0.025759, 0.114741],
    [0.246513, -0.557158, -0.792973, 0.172440],
]
# (a, d, alpha) of joints 1 to 7 and the flange.
DH = [
    (0.0, 0.333, 0.0),
    (0.0, 0.0, -pi / 2),
    (0.0, 0.316, pi / 2),
    (0.0825, 0.0, pi / 2),
    (-0.0825, 0.384, -pi / 2),
    (0.0, 0.0, pi / 2),
    (0.088, 0.0, pi / 2),
    (0.0, 0.107, 0.0),
]


def panda() -> tuple[Urdf, tuple[tuple[str, str], ...]]:
    description = load_robot_files("example-robot-data:panda")
    return load_urdf(description), disabled_collisions(description.srdf_path)


def panda_model(**options) -> mujoco.MjModel:
    urdf, pairs = panda()
    spec = new_world(0.001)
    add_robot(spec, urdf, RobotOptions(disabled_collisions=pairs, **options))
    return compile_world(spec)


def at_pose(model: mujoco.MjModel, q: list[float], fingers: float = 0.04):
    data = mujoco.MjData(model)
    data.qpos[:7] = q
    data.qpos[7:9] = fingers
    mujoco.mj_forward(model, data)
    return data


def small_model(body: str) -> mujoco.MjModel:
    xml = f'<robot name="r"><link name="base"/>{body}</robot>'
    urdf = load_urdf(RobotFiles("r", Path("r.urdf"), xml, None))
    spec = new_world(0.001)
    add_robot(spec, urdf, RobotOptions(armature=0.0))
    return compile_world(spec)


def hinge_to(link: str, *, attributes: str = "", effort: float = 5.0) -> str:
    return (
        f'{link}<joint name="j" type="revolute"><parent link="base"/>'
        f'<child link="b"/><limit effort="{effort}" velocity="1" lower="-1" upper="1"/>'
        f"{attributes}</joint>"
    )


def dh_flange(q: list[float]) -> np.ndarray:
    pose = np.eye(4)
    for (a, d, alpha), theta in zip(DH, [*q, 0.0], strict=True):
        ca, sa, ct, st = np.cos(alpha), np.sin(alpha), np.cos(theta), np.sin(theta)
        pose = pose @ [
            [ct, -st, 0, a],
            [st * ca, ct * ca, -sa, -d * sa],
            [st * sa, ct * sa, ca, d * ca],
            [0, 0, 0, 1],
        ]
    return pose


def test_flange_stands_where_the_published_vector_says() -> None:
    data = at_pose(panda_model(), Q_REFERENCE)
    flange = data.site("panda_link8")
    expected = np.array(FLANGE_REFERENCE)
    # The vector is printed to 6 decimals.
    assert flange.xpos == pytest.approx(expected[:, 3], abs=1e-6)
    assert flange.xmat == pytest.approx(expected[:, :3].ravel(), abs=1e-6)


def test_flange_agrees_with_dh_parameters_in_random_poses() -> None:
    model = panda_model()
    rng = np.random.default_rng(7)
    for q in rng.uniform(-2.8, 2.8, (20, 7)).tolist():
        flange = at_pose(model, q).site("panda_link8")
        expected = dh_flange(q)
        # Rounding of about ten products of rotations.
        assert flange.xpos == pytest.approx(expected[:3, 3], abs=1e-12)
        assert flange.xmat == pytest.approx(expected[:3, :3].ravel(), abs=1e-12)


def test_hand_tcp_is_a_site_at_the_published_place() -> None:
    tcp = at_pose(panda_model(), START).site("panda_hand_tcp")
    assert tcp.xpos == pytest.approx([0.306891, 0.0, 0.486882], abs=1e-6)
    assert tcp.xmat == pytest.approx(np.diag([1.0, -1.0, -1.0]).ravel(), abs=1e-12)


def test_bodies_have_the_masses_of_the_urdf() -> None:
    urdf, _ = panda()
    model = panda_model()
    for name, link in urdf.links.items():
        if link.inertial is not None:
            assert model.body(name).mass == pytest.approx(link.inertial.mass)


def test_gravity_torque_is_the_gradient_of_the_potential_energy() -> None:
    urdf, _ = panda()
    model = panda_model()

    def energy(q: list[float]) -> float:
        data = at_pose(model, q)
        return sum(
            9.81 * model.body(name).mass[0] * data.body(name).xipos[2]
            for name in urdf.links
            if urdf.links[name].inertial is not None
        )

    step = 1e-5
    gravity = at_pose(model, Q_REFERENCE).qfrc_bias[:7]
    for joint in range(7):
        up, down = list(Q_REFERENCE), list(Q_REFERENCE)
        up[joint] += step
        down[joint] -= step
        slope = (energy(up) - energy(down)) / (2 * step)
        # Central differences of an energy of 60 J: 1e-14 * 60 / 2e-5.
        assert gravity[joint] == pytest.approx(slope, abs=1e-6)


def test_gravity_compensation_carries_the_robot_in_every_pose() -> None:
    model = panda_model()
    rng = np.random.default_rng(3)
    for q in rng.uniform(-2.5, 2.5, (10, 7)).tolist():
        data = at_pose(model, q)
        assert data.qfrc_gravcomp == pytest.approx(data.qfrc_bias, abs=1e-10)


def test_robot_without_gravity_compensation_falls() -> None:
    data = at_pose(panda_model(gravity_compensation=False), START)
    assert not data.qfrc_gravcomp.any()
    assert abs(data.qacc[3]) > 1.0


def test_limits_damping_armature_and_effort_come_from_urdf_and_options() -> None:
    model = panda_model(armature=0.2)
    assert model.joint("panda_joint4").range.tolist() == [-3.0718, -0.0698]
    assert model.joint("panda_joint1").damping == 0.003
    assert model.joint("panda_joint1").armature == 0.2
    assert model.actuator("panda_joint7").forcerange.tolist() == [-12.0, 12.0]
    assert model.opt.timestep == 0.001
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST


def test_arm_touches_nothing_in_poses_over_the_table() -> None:
    model = panda_model()
    rng = np.random.default_rng(11)
    usual = [START, [0.0, 0.0, 0.0, -1.0, 0.0, 1.6, 0.0]]
    spread = np.array([1.5, 0.5, 0.5, 0.5, 1.0, 0.5, 2.0])
    usual += (np.array(START) + rng.uniform(-1, 1, (200, 7)) * spread).tolist()
    for q in usual:
        for fingers in (0.0, 0.04):
            assert at_pose(model, q, fingers).ncon == 0, q


def test_arm_touches_the_floor_and_its_own_base() -> None:
    model = panda_model()
    down = [0.0, 1.7, 0.0, -0.5, 0.0, 1.5, 0.0]
    contacts = at_pose(model, down).contact
    assert {int(geom) for geom in contacts.geom1} == {model.geom("floor").id}


def test_second_finger_follows_the_first() -> None:
    model = panda_model()
    data = at_pose(model, START, 0.02)
    data.actuator("panda_finger_joint1").ctrl = 2.0
    for _ in range(200):
        mujoco.mj_step(model, data)
    # The stop gives way by some micrometres under 2 N.
    assert data.qpos[7] == pytest.approx(0.04, abs=1e-4)
    assert data.qpos[8] == pytest.approx(data.qpos[7], abs=1e-4)


def test_two_arms_stand_at_their_own_base_poses() -> None:
    description = load_robot_files("example-robot-data:panda")
    spec = new_world(0.001)
    bases = {
        "left_": Pose((0.0, 0.5, 0.1)),
        "right_": Pose.from_rpy((0.0, -0.5, 0.0), (0.0, 0.0, pi / 2)),
    }
    for prefix, base in bases.items():
        urdf = load_urdf(description.with_prefix("panda_", prefix))
        add_robot(spec, urdf, RobotOptions(base=base))
    model = compile_world(spec)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.site("left_link8").xpos == pytest.approx([0.088, 0.5, 1.026])
    assert data.site("right_link8").xpos == pytest.approx([0.0, -0.412, 0.926])


def test_two_robots_with_the_same_name_are_refused() -> None:
    urdf, _ = panda()
    spec = new_world(0.001)
    add_robot(spec, urdf, RobotOptions())
    with pytest.raises(RobotDescriptionError, match="repeated name 'panda_link0'"):
        add_robot(spec, urdf, RobotOptions())


def test_inertia_is_turned_with_its_origin() -> None:
    body = (
        '<link name="b"><inertial><origin xyz="0 1 0" rpy="0 0 1.5707963267948966"/>'
        '<mass value="2"/><inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0" '
        'iyz="0"/></inertial></link>'
    )
    model = small_model(hinge_to(body, attributes='<axis xyz="1 0 0"/>'))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    # Steiner: 2 kg * (1 m)^2 plus the moment about the turned y axis.
    assert data.M[0] == pytest.approx(2.2)


def test_link_carries_a_point_mass() -> None:
    solid = (
        '<link name="b"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" '
        'izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )
    point = (
        '<link name="c"><inertial><mass value="3"/><inertia ixx="0" iyy="0" izz="0" '
        'ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="f" type="fixed">'
        '<parent link="b"/><child link="c"/><origin xyz="0 2 0"/></joint>'
    )
    model = small_model(hinge_to(solid) + point)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.body("b").mass == 4.0
    assert data.M[0] == pytest.approx(0.1 + 3 * 2**2)


def test_moving_link_without_mass_is_refused_by_name() -> None:
    with pytest.raises(RobotDescriptionError, match=r"'b': .*mass and inertia"):
        small_model(hinge_to('<link name="b"/>'))


def test_joint_without_effort_has_no_motor() -> None:
    solid = (
        '<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" '
        'ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )
    assert small_model(hinge_to(solid, effort=0.0)).nu == 0
    assert small_model(hinge_to(solid)).nu == 1


@pytest.mark.parametrize("name", ["ur5", "talos_left_arm", "z1", "xarm7", "pr2"])
def test_other_robots_can_be_built(name: str) -> None:
    description = load_robot_files(f"example-robot-data:{name}")
    urdf = load_urdf(description)
    spec = new_world(0.001)
    add_robot(spec, urdf, RobotOptions())
    assert compile_world(spec).nu > 0


TABLE = {
    "name": "table",
    "type": "table",
    "size": [1, 1, 0.4],
    "position": [0.5, 0, 0.4],
}
BALL = {"name": "ball", "type": "sphere", "size": [0.05], "mass": 0.2}


def build(*entries):
    spec = new_world(0.001)
    for entry in entries:
        add_object(spec, read_object(entry, "x"))
    model = compile_world(spec)
    data = mujoco.MjData(model)
    return model, data


def test_ball_falls_onto_the_table_and_stays_there():
    model, data = build(TABLE, {**BALL, "position": [0.5, 0, 0.6]})
    for _ in range(2_000):
        mujoco.mj_step(model, data)
    assert data.body("ball").xpos[2] == pytest.approx(0.45, abs=2e-3)
    assert data.body("table").xpos[2] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"type": "cone"}, "type' is 'cone'; it must be one of"),
        ({"size": [0.1, 0.1]}, "size' is .* it must be 1 finite"),
        ({"size": [-0.1]}, "it must be above 0"),
        (
            {"size": [1e300]},
            "it must be above 0, and 1000 m at most",
        ),
        ({"position": [0, -1e6, 0]}, "position' is .* it must be within 1000 m"),
        ({"mass": -1.0}, "it must be 0 or more"),
        ({"mass": 1e308}, "it must be 0 or more, 1e.06 kg and 100 at most"),
        ({"friction": 1e308}, "it must be 0 or more, 1e.06 kg and 100 at most"),
        ({"file": "ball.stl"}, "file' is 'ball.stl'; it must be left out"),
        ({"texture": "wood"}, "with keys of"),
        ({"colour": "red"}, "must be 3 finite"),
        ({"colour": [1.5, 0, 0]}, "whole numbers from 0 to 255"),
        ({"role": "wall"}, "one of .*keep_out"),
        ({"role": "fence", "mass": 1.0}, "a fence stays where it is"),
        ({"margin": -0.01}, "0 to 1000 m"),
        ({"margin": 1e308}, "0 to 1000 m"),
        ({"links": "hand"}, "a list of names"),
        ({"name": ""}, "name' is ''"),
        ({"name": "a\nb"}, "must be a name of printable characters"),
        ({"name": "a/b"}, "characters without /, and not of dots and spaces"),
        ({"name": " .."}, "characters without /, and not of dots and spaces"),
        ({"type": "mesh", "size": []}, "path of a mesh file"),
    ],
)
def test_impossible_thing_is_refused(change, problem):
    with pytest.raises(ParameterError, match=problem):
        read_object({**BALL, **change}, "scene/objects/0")


def test_names_are_unlike():
    tree = ParameterTree({"scene": {"objects": [BALL, BALL]}})
    with pytest.raises(ParameterError, match="unlike names"):
        read_scene(Parameters(tree))
    assert read_scene(Parameters(ParameterTree({}))) == []


@pytest.mark.parametrize(
    ("name", "size", "problem"),
    [("hull", 10, "has no extension"), ("hull.stl", 3_000_000_000, "3000000000 bytes")],
)
def test_file_that_is_no_mesh_is_refused_with_its_key(tmp_path, name, size, problem):
    path = tmp_path / name
    with path.open("wb") as file:
        file.truncate(size)
    entry = {"name": "hull", "type": "mesh", "file": str(path)}
    with pytest.raises(ParameterError, match=problem) as caught:
        read_object(entry, "scene/objects/0")
    assert "'scene/objects/0/file'" in caught.value.message
