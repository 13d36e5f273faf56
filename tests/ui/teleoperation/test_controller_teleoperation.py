"""What a person asks of one controller, with an injected clock."""

import pytest

from station.ui.teleoperation.commanded_controller import choose_for_joints
from station.ui.teleoperation.joint_teleoperation import (
    HELD_FOR,
    ControllerTeleoperation,
)
from station.ui.teleoperation.set_point_ramp import Movers
from tests.ui.views import controller, element, sample, view

NAMES = ("joint1", "joint2")
SPEED = 0.5


def _view(**changes):
    elements = tuple(element(name) for name in NAMES)
    parts = {
        "elements": {"arm": elements},
        "samples": {"arm": sample(1.0, desired=0.1, names=NAMES)},
        **changes,
    }
    return view(controller("arm", "running", NAMES), **parts)


@pytest.fixture
def desk():
    made = ControllerTeleoperation(Movers())
    _refresh(made, _view())
    return made


def _refresh(desk, seen):
    desk.refresh(choose_for_joints(seen)[0], seen)


def test_nothing_is_sent_unasked(desk):
    assert desk.step(0.04, SPEED, 0.0) is None


def test_a_typed_value_arrives_exactly_and_no_faster_than_allowed(desk):
    assert desk.go({"joint2": 0.3217}, now=0.0) == ""
    first = desk.step(0.04, SPEED, 0.04)
    assert first.controller == "arm"
    assert first.values == [None, pytest.approx(0.12)]
    sent = [desk.step(0.04, SPEED, 1.0) for _ in range(14)]
    assert [s.values for s in sent if s is not None][-1] == [None, 0.3217]
    assert sent[-1] is None


def test_a_value_out_of_range_moves_nothing(desk):
    said = desk.go({"joint1": 0.2, "joint2": 1.5}, now=0.0)
    assert said == "joint2 cannot go to 1.5 rad; allowed are -1 to 1 rad."
    assert desk.step(0.04, SPEED, 0.0) is None


def test_an_unknown_joint_is_named(desk):
    assert "does not command elbow" in desk.go({"elbow": 0.0}, now=0.0)
    assert "does not command elbow" in desk.hold("elbow", 1, now=0.0)


def test_a_held_button_moves_until_it_is_released(desk):
    desk.hold("joint1", -1, now=0.0)
    moved = desk.step(0.04, SPEED, 0.04)
    assert moved.values[0] == pytest.approx(0.08)
    desk.release()
    assert desk.step(0.04, SPEED, 0.08) is None


def test_a_browser_that_falls_silent_releases_its_buttons(desk):
    desk.hold("joint1", 1, now=0.0)
    assert desk.step(0.04, SPEED, HELD_FOR - 0.01) is not None
    assert desk.step(0.04, SPEED, HELD_FOR + 0.01) is None
    assert desk.remaining == 0.0


def test_releasing_a_button_ends_no_motion_to_a_typed_value(desk):
    desk.go({"joint2": 0.5}, now=0.0)
    desk.hold("joint1", 1, now=0.0)
    desk.step(0.04, SPEED, 0.04)
    desk.release()
    assert desk.step(0.04, SPEED, 0.08).values == [None, pytest.approx(0.14)]


def test_a_held_button_does_not_take_back_what_somebody_else_moves_since():
    movers = Movers()
    ada, grace = ControllerTeleoperation(movers), ControllerTeleoperation(movers)
    for one in (ada, grace):
        _refresh(one, _view())
        one.hold("joint1", 1, now=0.0)
        one.step(0.04, SPEED, 0.04)
        one.confirm()
    ada.hold("joint1", 1, now=0.05)
    assert ada.give_up_lost() == ["joint1"]
    assert ada.step(0.04, SPEED, 0.08) is None
    assert grace.give_up_lost() == []


@pytest.mark.parametrize(("unit", "limit"), [("m", 1.0), ("rad", None)])
def test_joints_that_slide_or_turn_without_end_move_while_a_button_is_held(unit, limit):
    desk = ControllerTeleoperation(Movers())
    ends = {"minimum": None if limit is None else -limit, "maximum": limit}
    elements = {"arm": tuple(element(name, unit, **ends) for name in NAMES)}
    _refresh(desk, _view(elements=elements))
    values = []
    for round_ in range(100):
        assert desk.hold("joint1", -1, now=0.04 * round_) == ""
        values.append(desk.step(0.04, SPEED, 0.04 * round_).values[0])
    least = 0.1 - 100 * 0.04 * SPEED
    assert min(values) == pytest.approx(least if limit is None else -limit)
    desk.release()
    assert desk.step(0.04, SPEED, 4.0) is None


@pytest.mark.parametrize(
    "change", [{"stop_state": "stopped"}, {"age": 5.0}, {"elements": {}}]
)
def test_no_motion_survives_a_stop_a_lost_link_or_another_controller(desk, change):
    desk.go({"joint1": 0.9}, now=0.0)
    _refresh(desk, _view(**change))
    assert desk.step(0.04, SPEED, 0.04) is None
    assert desk.go({"joint1": 0.9}, now=0.0) != ""


def test_velocities_are_typed_and_not_jogged():
    desk = ControllerTeleoperation(Movers())
    elements = {"arm": tuple(element(name, "rad/s") for name in NAMES)}
    _refresh(desk, _view(elements=elements))
    assert "takes rad/s, not positions" in desk.hold("joint1", 1, now=0.0)
    desk.go({"joint1": 0.4}, now=0.0)
    assert desk.step(0.04, SPEED, 0.04).values == [0.4, None]
