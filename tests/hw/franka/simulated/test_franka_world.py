"""Franka arms are put into a world under their own names."""

from pathlib import Path

import pytest

from station.core.errors import RobotDescriptionError
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.franka_world import (
    ArmPlacement,
    find_prefix,
    joint_names,
    simulate,
)
from station.hw.robot_description import RobotDescription, load_robot_description


def test_joints_are_named_after_the_arm() -> None:
    assert joint_names("left") == [f"left_joint{number}" for number in range(1, 8)]


@pytest.mark.parametrize("arm_id", ["panda", "left"])
def test_arm_starts_at_the_asked_pose_with_open_hand(arm_id: str) -> None:
    description = load_robot_description("example-robot-data:panda")
    positions = (0.1, *INITIAL_POSITIONS[1:])
    placement = ArmPlacement(arm_id, description, positions=positions)
    simulation = simulate([placement], timestep=0.002)
    assert simulation.arms[arm_id].state.q == list(positions)
    assert simulation.world.data.qpos[7:].tolist() == [0.04, 0.04]
    assert simulation.arms[arm_id].cycle_time == 0.002


def test_prefix_is_that_of_the_seven_joints() -> None:
    description = load_robot_description("example-robot-data:panda")
    assert find_prefix(description) == "panda_"
    assert find_prefix(description.with_prefix("panda_", "")) == ""


def test_other_robot_is_refused() -> None:
    with pytest.raises(RobotDescriptionError, match="is no Franka arm"):
        find_prefix(load_robot_description("example-robot-data:ur5"))


def test_arm_without_hand_has_no_gripper() -> None:
    full = load_robot_description("example-robot-data:panda")
    xml = full.xml[: full.xml.index('<joint name="panda_hand_joint"')] + "</robot>"
    bare = RobotDescription("bare", Path(full.urdf_path), xml, full.srdf_path)
    simulation = simulate([ArmPlacement("panda", bare)])
    assert simulation.grippers == {}
    assert simulation.world.model.nq == 7
