"""First values of the form that loads a controller."""

import pytest
import yaml

from station.ui.page.controller_offers import example_parameters, suggested_name

JOINTS = ["panda_joint1", "panda_joint2", "panda_finger_joint1"]


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (
            "effort_controllers/JointGroupPositionController",
            {
                "joints": JOINTS[:2],
                "panda_joint1": {"pid": {"p": 600, "i": 0, "d": 30}},
                "panda_joint2": {"pid": {"p": 600, "i": 0, "d": 30}},
            },
        ),
        ("effort_controllers/JointGroupEffortController", {"joints": JOINTS[:2]}),
        ("position_controllers/JointGroupPositionController", {"joints": JOINTS[:2]}),
        (
            "effort_controllers/JointPositionController",
            {"joint": JOINTS[0], "pid": {"p": 600, "i": 0, "d": 30}},
        ),
        ("velocity_controllers/JointVelocityController", {"joint": JOINTS[0]}),
        ("joint_state_controller/JointStateController", {"publish_rate": 50}),
    ],
)
def test_examples_fit_the_robot(kind, expected):
    assert yaml.safe_load(example_parameters(kind, JOINTS)) == expected


def test_there_is_no_example_without_joints():
    kind = "position_controllers/JointGroupPositionController"
    assert example_parameters(kind, []) == ""


def test_names_are_short_and_free():
    kind = "effort_controllers/JointGroupPositionController"
    assert suggested_name(kind, []) == "effort_position"
    assert suggested_name(kind, ["effort_position"]) == "effort_position_2"


@pytest.mark.parametrize(
    "kind", ["CartesianJogController", "CartesianStreamingController"]
)
def test_cartesian_examples_name_the_arm(kind):
    kind = f"franka_controllers/{kind}"

    assert yaml.safe_load(example_parameters(kind, JOINTS)) == {
        "arm_id": "panda",
        "joint_names": JOINTS[:2],
    }
    assert (
        suggested_name("franka_controllers/CartesianJogController", []) == "franka_jog"
    )


@pytest.mark.parametrize(
    ("asked", "arm", "first"), [("", "panda_1", 0), ("panda_2", "panda_2", 2)]
)
def test_a_controller_of_one_arm_has_the_joints_of_that_arm(asked, arm, first):
    joints = [f"panda_{arm}_joint{i}" for arm in (1, 2) for i in (1, 2)]

    kind = "franka_controllers/CartesianJogController"
    assert yaml.safe_load(example_parameters(kind, joints, asked)) == {
        "arm_id": arm,
        "joint_names": joints[first : first + 2],
    }


def test_streaming_and_jogging_take_all_joints():
    kind = "position_controllers/JointStreamingController"

    assert yaml.safe_load(example_parameters(kind, JOINTS)) == {"joints": JOINTS[:2]}
