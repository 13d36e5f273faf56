"""The URDF of an arm has the values of its kind, and nothing else changes."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import RobotDescriptionError
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS
from station.hw.urdf_loader import load_urdf

PANDA = "example-robot-data:panda"


def test_panda_is_as_its_urdf_says():
    assert load_arm_description(PANDA, PANDA_LIMITS) == load_robot_files(PANDA)


def test_fr3_of_a_pandas_urdf_gets_its_limits():
    joints = load_urdf(load_arm_description(PANDA, FR3_LIMITS)).joints
    # franka_description/robots/fr3/joint_limits.yaml
    limit, safety = joints["panda_joint6"].limit, joints["panda_joint6"].safety
    assert (limit.lower, limit.upper, limit.velocity) == (0.8521, 4.2094, 1.5)
    assert (safety.soft_lower_limit, safety.soft_upper_limit) == (0.8521, 4.2094)
    assert (safety.k_position, safety.k_velocity, limit.effort) == (100.0, 40.0, 12.0)
    speeds = [joints[f"panda_joint{number}"].limit.velocity for number in range(1, 8)]
    assert speeds == [2.0, 1.0, 1.5, 1.25, 3.0, 1.5, 3.0]


def test_fr3_of_a_pandas_urdf_gets_its_masses_and_keeps_shapes_and_hand():
    panda = load_urdf(load_robot_files(PANDA))
    fr3 = load_urdf(load_arm_description(PANDA, FR3_LIMITS))
    # franka_description/robots/fr3/inertials.yaml
    link = fr3.links["panda_link4"].inertial
    assert (link.mass, link.origin.xyz[1], link.inertia[3:]) == (
        2.6155955791,
        0.063049296,
        (0.01322552265982813, 0.01015142998484113, -0.0009762833870704552),
    )
    arm = {f"panda_link{number}" for number in range(8)}
    masses = [fr3.links[name].inertial.mass for name in sorted(arm)]
    assert sum(masses) == pytest.approx(17.8914010262)
    for name, link in panda.links.items():
        kept = fr3.links[name]
        assert kept.collisions == link.collisions
        assert (kept.inertial == link.inertial) == (name not in arm)
    finger = "panda_finger_joint1"
    assert fr3.joints[finger] == panda.joints[finger]


def test_urdf_with_other_names_stays_as_it_is(tmp_path):
    path = tmp_path / "fr3.urdf"
    path.write_text(load_robot_files(PANDA).with_prefix("panda_", "fr3_").xml)
    joints = load_urdf(load_arm_description(str(path), FR3_LIMITS)).joints
    assert joints["fr3_joint6"].limit.upper == 3.7525
    mass = load_urdf(load_arm_description(str(path), FR3_LIMITS)).links["fr3_link1"]
    assert mass.inertial.mass == 4.970684


def test_other_robot_is_refused():
    with pytest.raises(RobotDescriptionError, match="no Franka arm"):
        load_arm_description("example-robot-data:ur5", PANDA_LIMITS)
