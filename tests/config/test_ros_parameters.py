"""Parameter files written for ROS load unchanged."""

import pytest

from station.config.ros_parameters import split_ros_parameters, substitute
from station.core.errors import ConfigError

ARM = {"type": "effort_controllers/JointTrajectoryController", "joints": ["j1"]}


@pytest.mark.parametrize(
    "values",
    [
        {"arm": ARM, "joint_limits": {"j1": 1}},
        {"panda": {"arm": ARM, "joint_limits": {"j1": 1}}},
        {"/panda": {"inner": {"arm": ARM}, "joint_limits": {"j1": 1}}},
    ],
)
def test_controllers_are_found_in_any_namespace(values):
    found = split_ros_parameters(values, "f.yaml")

    assert found.controllers == {"arm": ARM}
    assert found.others == {"joint_limits": {"j1": 1}}


def test_blocks_of_a_controller_stay_as_they_are():
    arm = {
        **ARM,
        "gains": {"j1": {"p": 600, "d": 30}},
        "constraints": {"goal_time": 0.5, "j1": {"goal": 0.05}},
    }

    assert split_ros_parameters({"arm": arm}, "f").controllers == {"arm": arm}


def test_mapping_with_a_type_that_is_no_plugin_is_no_controller():
    values = {"camera": {"type": "usb"}, "rate": 100}

    found = split_ros_parameters(values, "f.yaml")

    assert found.controllers == {}
    assert found.others == values


def test_name_in_two_namespaces_is_refused():
    with pytest.raises(ConfigError, match="/right/arm has a name that another"):
        split_ros_parameters({"left": {"arm": ARM}, "right": {"arm": ARM}}, "f.yaml")


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"joint_limit": {"j1": {}}}, "/joint_limit has no effect. .*'joint_limits'"),
        ({"panda": {"arm": ARM, "sceen": {}}}, "/panda/sceen .*'scene'"),
        ({"arm": {"typ": ARM["type"], "joints": ["j1"]}}, "/arm/typ .*'type'"),
        ({"arm": {"Type": ARM["type"], "joints": ["j1"]}}, "/arm/Type .*'type'"),
    ],
)
def test_a_misspelt_key_is_refused_with_the_nearest_name(values, said):
    with pytest.raises(ConfigError, match=said):
        split_ros_parameters(values, "f.yaml")


@pytest.mark.parametrize(
    "key", ["robot_description_planning", "robot_description_semantic", "use_sim_time"]
)
def test_a_key_of_another_program_is_kept(key):
    assert split_ros_parameters({key: 1}, "f.yaml").others == {key: 1}


def test_arguments_are_substituted_in_texts_and_keys():
    values = {"$(arg arm_id)_joint1": ["$(arg arm_id)_joint1", 1, {"x": None}]}

    assert substitute(values, {"arm_id": "left"}, "f") == {
        "left_joint1": ["left_joint1", 1, {"x": None}]
    }


@pytest.mark.parametrize("text", ["$(find franka)/x", "$(arg other)", "$(env HOME)"])
def test_other_substitutions_are_refused(text):
    with pytest.raises(ConfigError, match="cannot be replaced") as caught:
        substitute([text], {"arm_id": "left"}, "f.yaml")

    assert "$(arg arm_id)" in caught.value.remedy
