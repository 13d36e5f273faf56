"""Public parameter files written for ROS load unchanged, and their controllers run.

`tests/data/ros_yaml` holds files with the keys and values of those of franka_ros,
ros_controllers, gazebo_ros_demos, universal_robot, Universal_Robots_ROS_Driver and
panda_moveit_config, in folders that are named after the package.
"""

from pathlib import Path

import pytest

from station.app.composition import compose
from station.config import load_config
from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller import ControllerState
from station.core.control.switching import SwitchRequest

FOLDER = Path(__file__).parents[1] / "data" / "ros_yaml"
PENDULUM = f"""
robot:
  type: mujoco_hw/MujocoRobotHW
  robot_description: {FOLDER / "rrbot.urdf"}
"""
MOCK = """
station: {rate: 100}
robot: {type: mock_hw/MockRobotHW, joints: [joint1, joint2]}
"""
RRBOT = """
station: {rate: 100}
robot: {type: "tests.controllers.joint_trajectory_controller.rrbot:RRBotHW"}
"""
SIMPLE_BOT = f"""
robot:
  type: mujoco_hw/MujocoRobotHW
  robot_description: {FOLDER / "effort_controllers" / "simple_bot.urdf"}
"""
UR5 = """
robot:
  type: mujoco_hw/MujocoRobotHW
  robot_description: example-robot-data:ur5
  sensors: {wrist: {type: force_torque, link: wrist_3_link}}
"""
PANDA = "station: {}\n"
"""Robots by the folder their files are in; by the file where that is not enough."""
ROBOTS = {
    "effort_controllers": SIMPLE_BOT,
    "franka_control": PANDA,
    "franka_example_controllers": PANDA,
    "franka_gazebo": PANDA,
    "gazebo_ros_demos": PENDULUM,
    "gripper_action_controller": PANDA,
    "joint_state_controller": MOCK,
    "joint_trajectory_controller": PENDULUM,
    "rrbot_pos_vel_controllers.yaml": RRBOT,
    "rrbot_pos_vel_acc_controllers.yaml": RRBOT,
    "panda_moveit_config": PANDA,
    "sensors": MOCK,
    "ur_gazebo": UR5,
    "ur_robot_driver": UR5,
}
FILES = sorted(FOLDER.rglob("*.yaml"))


def robot_for(file):
    """Return the configuration of a robot that fits a parameter file."""
    return ROBOTS.get(file.name) or ROBOTS[file.parent.name]


@pytest.fixture(params=FILES, ids=lambda path: str(path.relative_to(FOLDER)))
def loaded(request, tmp_path):
    """Return the names of a file's controllers, and a station that has loaded it."""
    path = tmp_path / "station.yaml"
    path.write_text(robot_for(request.param) + "controllers: {}\n")
    config = load_config(path, controller_files=[request.param])
    return config, compose(config, ManualClock())


# Examples for two arms in the file for one.
TWO_ARMED = {
    "franka_example_controllers/DualArmCartesianImpedanceExampleController",
    "franka_example_controllers/TeleopJointPDExampleController",
}


def test_only_what_nobody_here_has_is_not_loaded(loaded):
    config, composition = loaded
    kinds = {
        name: each["type"] for name, each in config.controller_parameters().items()
    }
    known = CONTROLLERS.keys() - TWO_ARMED
    unknown = {name for name, kind in kinds.items() if kind not in known}
    assert set(composition.not_loaded) == unknown
    assert not [each for each in composition.warnings() if "is unknown" in each]
    loaded_here = {status.name for status in composition.station.controllers()}
    assert loaded_here == set(kinds) - unknown


def test_every_controller_runs(loaded):
    _, composition = loaded
    station = composition.station
    station.loop.step(5)
    for status in station.controllers():
        assert station.switch_controllers(SwitchRequest(start=(status.name,))).ok
        station.loop.step(50)
        running = station.controller(status.name)
        assert running.fault is None
        assert running.state is ControllerState.RUNNING
        station.switch_controllers(SwitchRequest(stop=(status.name,)))
        station.loop.step(5)


def test_other_parameters_are_there_for_controllers_and_robots(tmp_path):
    path = tmp_path / "station.yaml"
    path.write_text(PANDA)
    file = FOLDER / "panda_moveit_config" / "joint_limits.yaml"
    composition = compose(load_config(path, controller_files=[file]), ManualClock())
    limits = composition.station.parameters.get("joint_limits")
    assert limits["panda_joint2"]["max_acceleration"] == 1.875
