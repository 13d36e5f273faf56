"""A robot in its world, at its start pose."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.mujoco_robot_parameters import read_parameters
from station.hw.mujoco.mujoco_simulation import simulate_robot
from station.hw.urdf_loader import load_urdf


def simulate(robot: str, **parameters: object):
    reference = f"example-robot-data:{robot}"
    description = load_robot_files(reference)
    values = {"robot_description": reference, **parameters}
    return simulate_robot(
        description,
        load_urdf(description),
        read_parameters(Parameters(ParameterTree(values))),
    ).world


def position(world, joint: str) -> float:
    return float(world.data.joint(joint).qpos[0])


def test_joints_start_as_wanted_else_at_zero_else_in_mid_range():
    world = simulate("panda", initial_positions={"panda_joint1": 0.5})
    assert position(world, "panda_joint1") == 0.5
    assert position(world, "panda_joint2") == 0.0
    assert position(world, "panda_joint4") == pytest.approx((-3.0718 - 0.0698) / 2.0)


def test_mimic_joint_starts_at_the_position_of_its_rule():
    world = simulate("panda", initial_positions={"panda_finger_joint1": 0.03})
    assert position(world, "panda_finger_joint2") == 0.03


@pytest.mark.parametrize(
    ("joint", "value"), [("panda_joint1", 3.0), ("panda_joint9", 0.0)]
)
def test_impossible_start_is_refused(joint, value):
    with pytest.raises(ParameterError, match=joint):
        simulate("panda", initial_positions={joint: value})


def test_base_stands_at_the_configured_position():
    world = simulate("ur5", base_xyz=[0.0, 0.0, 0.75], floor=False)
    assert world.data.body("base_link").xpos[2] == pytest.approx(0.75)
