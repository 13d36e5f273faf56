"""Starts and texts that the dock Controllers offers."""

from dataclasses import replace

import pytest
import yaml

from station.ui.page.controller_offers import (
    Offer,
    claims_text,
    command_units,
    example_parameters,
    offer_for,
    suggested_name,
)
from station.wire import ClaimedResources
from tests.ui.views import arm, controller, status, view


def _offer(seen):
    """Return the offer for the first controller."""
    return offer_for(seen, seen.controllers[0])


def test_a_free_controller_can_be_started_and_unloaded():
    assert _offer(view(controller("arm"))) == Offer()


def test_a_running_controller_can_only_be_stopped():
    offer = _offer(view(controller("arm", "running")))
    assert offer.replaces == ()
    assert "Stop it before" in offer.reason


def test_the_holder_of_its_joints_is_named():
    seen = view(controller("arm"), controller("other", "running"))
    offer = _offer(seen)
    assert offer.replaces == ("other",)
    assert "other" in offer.reason


@pytest.mark.parametrize("starts", ["joints", "hand"])
def test_a_motion_of_the_hand_and_one_of_its_joints_replace_each_other(starts):
    """An arm whose joints are held by torques would ignore where its hand shall go."""
    joints = [f"panda_joint{i}" for i in range(1, 8)]
    claims = {"joints": joints, "hand": ["panda_robot"]}
    running = next(name for name in claims if name != starts)
    seen = view(
        controller(starts, joints=claims[starts]),
        controller(running, "running", claims[running]),
        controller("fingers", "running", ["panda_finger_joint1"]),
        controller("neighbour", "running", ["panda_2_joint1"]),
        positions=dict.fromkeys([*joints, "panda_finger_joint1", "panda_2_joint1"], 0),
    )
    seen = replace(seen, status=status(robots=[arm("panda", "move")]))
    assert _offer(seen).replaces == (running,)


def test_other_joints_do_not_conflict():
    seen = view(controller("arm"), controller("leg", "running", ["leg1"]))
    assert _offer(seen) == Offer()


def test_nothing_is_started_without_a_link():
    assert "link" in _offer(view(controller("arm"), age=9.0)).reason


def test_nothing_is_started_while_stopped():
    offer = _offer(view(controller("arm"), stop_state="stopped"))
    assert "stopped" in offer.reason


@pytest.mark.parametrize(
    ("joints", "text"),
    [
        ([], "nothing"),
        (["a", "b"], "EffortJoint: a, b"),
        ([f"panda_joint{i}" for i in range(1, 8)], "EffortJoint: panda_joint1…7"),
        (["hip", "knee", "toe"], "EffortJoint: hip and 2 more"),
    ],
)
def test_claims_fit_a_table_cell(joints, text):
    assert claims_text(controller("arm", joints=joints)) == text


@pytest.mark.parametrize(
    ("interface", "units"),
    [
        ("EffortJointInterface", {"turn": "Nm", "slide": "N"}),
        ("PositionJointInterface", {"turn": "rad", "slide": "m"}),
        ("PosVelJointInterface", {"turn": "rad", "slide": "m"}),
        ("VelocityJointInterface", {"turn": "rad/s", "slide": "m/s"}),
        ("JointStateInterface", {}),
    ],
)
def test_commands_have_the_unit_of_their_interface(interface, units):
    claim = ClaimedResources(
        hardware_interface=f"hardware_interface::{interface}",
        resources=["turn", "slide"],
    )
    commanding = controller("arm").model_copy(update={"claimed_resources": [claim]})
    assert command_units(commanding, {"slide"}) == units


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
