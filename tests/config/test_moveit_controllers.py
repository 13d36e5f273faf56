"""MoveIt's list of controllers, in the forms of its two managers."""

import pytest

from station.config.ros_parameters import controllers_of_list, split_ros_parameters
from station.core.errors import ConfigError

JOINTS = ["a", "b"]
ARM = {"name": "arm", "action_ns": "follow_joint_trajectory", "joints": JOINTS}
SIMPLE = {**ARM, "type": "FollowJointTrajectory", "default": True}
TRAJECTORY = "position_controllers/JointTrajectoryController"


def test_simple_manager_expects_trajectory_and_gripper_controllers() -> None:
    hand = {"name": "/robot/hand", "type": "GripperCommand", "joints": ["f", "g"]}
    assert controllers_of_list([SIMPLE, hand], "f.yaml") == {
        "arm": {"type": TRAJECTORY, "joints": JOINTS},
        "hand": {"type": "position_controllers/GripperActionController", "joint": "f"},
    }


def test_ros_control_names_the_type_of_the_controller() -> None:
    kind = "effort_controllers/JointTrajectoryController"
    found = controllers_of_list([{**ARM, "type": kind}], "f.yaml")
    assert found["arm"]["type"] == kind


def test_what_the_file_says_itself_goes_first() -> None:
    own = {"type": "velocity_controllers/JointTrajectoryController", "joints": ["x"]}
    found = split_ros_parameters({"controller_list": [SIMPLE], "arm": own}, "f.yaml")
    assert found.controllers == {"arm": own}
    assert "controller_list" not in found.others


def test_fake_controllers_are_nobody() -> None:
    assert controllers_of_list([{"name": "fake", "joints": JOINTS}], "f.yaml") == {}


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ({}, "controller_list is {}"),
        ([{"type": "FollowJointTrajectory"}], r"controller_list\[0\] has no name"),
        ([{**SIMPLE, "joints": "a"}], "has the joints 'a'"),
        ([{**SIMPLE, "type": "Magic"}], "has the type 'Magic'; known are Follow"),
    ],
)
def test_malformed_list_is_refused(value, reason) -> None:
    with pytest.raises(ConfigError, match=reason):
        controllers_of_list(value, "f.yaml")
