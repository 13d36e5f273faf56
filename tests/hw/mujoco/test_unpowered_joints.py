"""Joints without a motor have a state."""

from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.testing import Bench


def test_mimic_joint_has_a_state_and_no_command() -> None:
    reference = "example-robot-data:panda"
    start = {"panda_finger_joint1": 0.03}
    bench = Bench(
        MujocoRobotHW(), {"robot_description": reference, "initial_positions": start}
    )
    robot = bench.robot
    states = robot.get_interface_resources("hardware_interface::JointStateInterface")
    efforts = robot.get_interface_resources("hardware_interface::EffortJointInterface")
    assert "panda_finger_joint2" in states
    assert "panda_finger_joint2" not in efforts
