"""What a person asks of the joints of two arms, each with a controller of its own."""

import pytest

from station.ui.teleoperation.joint_teleoperation import FASTEST, JointTeleoperation
from tests.ui.views import controller, element, sample, view

ARMS = {"left": ("left_joint1", "left_joint2"), "right": ("right_joint1",)}


def _view(*running, **changes):
    return view(
        *(controller(name, "running", ARMS[name]) for name in running),
        **{
            "elements": {n: tuple(map(element, ARMS[n])) for n in running},
            "samples": {n: sample(1.0, desired=0.1, names=ARMS[n]) for n in running},
            **changes,
        },
    )


@pytest.fixture
def desk():
    made = JointTeleoperation()
    made.refresh(_view("left", "right"))
    return made


def _sent(desk):
    return {one.controller: one.values for one in desk.step(0.04, 0.04)}


def test_all_running_controllers_are_commanded(desk):
    assert desk.controllers == ["left", "right"]
    assert desk.reason == ""
    assert _sent(desk) == {}


def test_a_value_goes_to_the_controller_of_its_joint_alone(desk):
    assert desk.go({"right_joint1": 0.11}, now=0.0) == ""
    assert _sent(desk) == {"right": [0.11]}
    assert desk.go({"left_joint2": 0.11}, now=0.0) == ""
    assert _sent(desk) == {"left": [None, 0.11]}


def test_a_pose_of_both_arms_moves_all_of_them_or_none(desk):
    refused = desk.go({"left_joint1": 0.11, "right_joint1": 7.0}, now=0.0)
    assert "right_joint1 cannot go to 7 rad" in refused
    assert _sent(desk) == {}
    assert desk.go({"left_joint1": 0.11, "right_joint1": 0.11}, now=0.0) == ""
    assert _sent(desk) == {"left": [0.11, None], "right": [0.11]}


def test_nothing_moves_while_it_is_not_known_where_one_arm_was_told_to_be():
    desk = JointTeleoperation()
    samples = {"left": sample(1.0, desired=0.1, names=ARMS["left"])}
    desk.refresh(_view("left", "right", samples=samples))
    refused = desk.go({"left_joint1": 0.11, "right_joint1": 0.11}, now=0.0)
    assert "not known yet" in refused
    assert _sent(desk) == {}


def test_a_button_of_each_arm_moves_it_until_it_is_released(desk):
    desk.set_speed(0.5)
    assert desk.hold("right_joint1", -1, now=0.0) == ""
    assert desk.hold("left_joint1", 1, now=0.0) == ""
    assert _sent(desk) == {
        "left": [pytest.approx(0.12), None],
        "right": [pytest.approx(0.08)],
    }
    desk.release()
    assert _sent(desk) == {}


def test_an_arm_goes_on_when_the_controller_of_the_other_stops(desk):
    desk.go({"left_joint1": 0.5, "right_joint1": 0.5}, now=0.0)
    desk.refresh(_view("right"))
    assert list(_sent(desk)) == ["right"]
    desk.refresh(_view("left", "right"))
    assert list(_sent(desk)) == ["right"]  # What ended does not go on by itself.
    desk.let_go()
    assert _sent(desk) == {}


def test_a_joint_that_nobody_commands_is_named(desk):
    assert "does not command elbow" in desk.go({"elbow": 0.0}, now=0.0)
    desk.refresh(_view())
    assert desk.controllers == []
    assert "nothing that runs takes set-points" in desk.reason
    assert desk.hold("left_joint1", 1, now=0.0) == desk.reason


def test_the_speed_stays_within_its_range(desk):
    desk.set_speed(99.0)
    assert desk.speed == FASTEST
