"""The commands of a person to an end effector, with an injected clock."""

import math
from dataclasses import replace

import pytest

from station.core.description.urdf import Pose
from station.ui.link.station_view import POSE, TWIST, ArmFacts
from station.ui.teleoperation.hand_teleoperation import (
    PATIENCE,
    STEPS_ADD_UP,
    HandSpeed,
    HandsTeleoperation,
    HandTeleoperation,
    HeldButtons,
    TargetPose,
    distance,
)
from station.ui.teleoperation.joint_teleoperation import HELD_FOR
from station.wire.rehearsal import Place
from tests.ui.views import arm, controller, element, sample, status, view

SPEED = HandSpeed(0.1, 0.4)
POSE_HERE = [0.3, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]
POSE_THERE = [0.4, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]
HERE = sample(1.0, desired=0.5, names=POSE)


def _view(names, **changes):
    elements = {"hand": tuple(element(name, "m") for name in names)}
    running = controller("hand", "running", ("panda_robot",))
    parts = {"elements": elements, "samples": {"hand": HERE}, **changes}
    return view(running, **parts)


@pytest.fixture
def desk():
    return HandTeleoperation()


def test_a_held_direction_moves_and_ends_with_one_rest(desk):
    desk.refresh(_view(TWIST))
    assert desk.hold(2, -1, now=0.0) == ""
    assert desk.step(0.1).values == pytest.approx([0, 0, -desk.speed.along, 0, 0, 0])
    desk.release()
    assert desk.step(0.2).values == [0.0] * 6
    assert desk.step(0.3) is None


def test_a_silent_browser_counts_as_released(desk):
    desk.refresh(_view(TWIST))
    desk.hold(0, 1, now=0.0)
    desk.step(0.1)
    assert desk.step(HELD_FOR + 0.1).values == [0.0] * 6


def test_a_typed_position_keeps_the_orientation(desk):
    desk.refresh(_view(POSE))
    assert desk.go([0.4, 0.1, 0.6], now=0.0) == ""
    assert desk.step(0.1).values == [0.4, 0.1, 0.6, 0.5, 0.5, 0.5, 0.5]


def test_without_a_controller_it_says_what_to_start(desk):
    desk.refresh(view())
    assert desk.hold(0, 1, now=0.0) != ""
    assert desk.go([0.4, 0.1, 0.6], now=0.0) != ""
    assert desk.step(0.1) is None


def test_what_keeps_the_hand_from_its_motion_is_told(desks):
    desks.refresh(_view(POSE, messages={"hand": "A singular pose is near."}))
    assert desks.state()[""]["message"] == "A singular pose is near."
    desks.refresh(_view(POSE))
    assert desks.state()[""]["message"] == ""


def test_a_stop_ends_the_motion(desk):
    desk.refresh(_view(POSE))
    desk.go([0.4, 0.1, 0.6], now=0.0)
    desk.refresh(_view(POSE, stop_state="stopped"))
    assert desk.step(0.1) is None


ARMS = ("left", "right")


def _two_arms(names):
    """Return a station with a running controller for each of two hands."""
    running = [
        controller(f"{arm_id}_hand", "running", (f"{arm_id}_robot",)) for arm_id in ARMS
    ]
    elements = tuple(element(name, "m", -0.5, 0.5) for name in names)
    return replace(
        view(
            *running,
            elements={one.name: elements for one in running},
            samples={one.name: HERE for one in running},
        ),
        status=status(robots=[arm(arm_id, "move") for arm_id in ARMS]),
    )


@pytest.fixture
def desks():
    return HandsTeleoperation()


@pytest.mark.parametrize("arm_id", ARMS)
def test_the_hand_of_the_chosen_arm_moves(desks, arm_id):
    desks.refresh(_two_arms(TWIST))
    assert desks.hold(arm_id, 0, 1, now=0.0) == ""
    assert [point.controller for point in desks.step(0.1)] == [f"{arm_id}_hand"]
    desks.refresh(_two_arms(POSE))
    assert desks.go(arm_id, [0.4, 0.1, 0.6], now=0.0) == ""
    assert [point.controller for point in desks.step(0.1)] == [f"{arm_id}_hand"]


def test_an_arm_that_is_not_there_is_refused(desks):
    desks.refresh(_two_arms(TWIST))
    assert desks.hold("third", 0, 1, now=0.0) == "This station has no arm 'third'."
    assert "third" in desks.go("third", [0.4, 0.1, 0.6], now=0.0)
    assert desks.step(0.1) == []


def test_a_single_arm_answers_to_its_own_name(desks):
    desks.refresh(_view(TWIST))
    assert desks.hold("panda", 0, 1, now=0.0) == ""
    assert list(desks.state()) == [""]


def test_the_hand_is_no_faster_than_chosen_and_than_its_controller_allows(desks):
    desks.set_speed(0.2, 2.0)
    desks.refresh(_two_arms(TWIST))
    desks.hold("left", 0, 1, now=0.0)
    desks.hold("left", 5, -1, now=0.0)
    (point,) = desks.step(0.1)
    assert point.values == pytest.approx([0.2, 0, 0, 0, 0, -0.5])
    assert desks.state()["left"]["fastest"] == [0.5, 0.5]


def test_a_held_button_counts_for_a_moment_and_ends_with_one_zero():
    buttons = HeldButtons()
    buttons.hold(1, -1, now=5.0)

    assert buttons.twist(5.0 + 0.9 * HELD_FOR, SPEED) == [0.0, -0.1, 0, 0, 0, 0]
    assert buttons.twist(5.0 + 1.1 * HELD_FOR, SPEED) == [0.0] * 6
    assert buttons.twist(5.0 + 1.2 * HELD_FOR, SPEED) is None


def test_a_button_that_was_let_go_ends_at_once():
    buttons = HeldButtons()
    buttons.hold(2, 1, now=0.0)
    buttons.twist(0.0, SPEED)
    buttons.release()

    assert buttons.twist(0.01, SPEED) == [0.0] * 6


def test_several_buttons_share_the_speed():
    buttons = HeldButtons()
    for axis in (0, 1, 5):
        buttons.hold(axis, 1, now=0.0)

    twist = buttons.twist(0.0, SPEED)
    assert twist == pytest.approx([0.0707, 0.0707, 0, 0, 0, 0.4], abs=1e-4)


def test_a_stick_moves_as_far_as_it_is_deflected():
    buttons = HeldButtons()
    buttons.hold(0, 0.5, now=0.0)
    buttons.hold(5, -0.25, now=0.0)
    wanted = pytest.approx([0.05, 0, 0, 0, 0, -0.1])
    assert buttons.twist(0.1, SPEED) == wanted
    buttons.hold(0, -0.2, now=0.1)
    assert buttons.twist(0.1, SPEED)[0] == pytest.approx(-0.02)
    buttons.hold(0, 0.0, now=0.1)
    assert buttons.twist(0.1, SPEED)[0] == 0.0


def test_letting_go_forgets_everything():
    buttons = HeldButtons()
    buttons.hold(0, 1, now=0.0)
    buttons.twist(0.0, SPEED)
    buttons.let_go()

    assert buttons.twist(0.0, SPEED) is None


def test_a_target_is_sent_until_the_arm_is_there():
    target = TargetPose()
    assert target.command(POSE_HERE, now=0.0) is None
    target.set(POSE_THERE, now=0.0)

    assert target.command(POSE_HERE, now=0.1) == POSE_THERE
    assert target.is_pursued
    assert target.command(POSE_THERE, now=0.2) == POSE_THERE
    assert not target.is_pursued


def test_a_target_that_comes_no_nearer_is_given_up():
    target = TargetPose()
    target.set(POSE_THERE, now=0.0)
    target.command(POSE_HERE, now=0.0)

    target.command(POSE_HERE, now=0.9 * PATIENCE)
    assert target.is_pursued
    target.command(POSE_HERE, now=1.1 * PATIENCE)
    assert not target.is_pursued


def test_a_quaternion_and_its_negative_are_no_distance_apart():
    assert distance(POSE_HERE, [*POSE_HERE[:3], -1.0, 0.0, 0.0, 0.0]) == 0.0
    assert distance(POSE_HERE, POSE_THERE) == pytest.approx(0.1)


DOWN = [0.3, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]
"""Turned half about x, as the hand of a Panda."""
QUARTER = math.pi / 2.0
HALF = math.sqrt(0.5)


def _looking_down(desk, **parts):
    samples = {"hand": HERE.model_copy(update={"desired": DOWN})}
    desk.refresh(_view(POSE, samples=samples, **parts))


def _step(desk, axis, size, now, *, is_of_tool=False):
    by = [size if i == axis else 0.0 for i in range(6)]
    quaternion = Place(position=by[:3], rpy=by[3:]).quaternion()
    return desk.go([*by[:3], *quaternion], now, "tool" if is_of_tool else "base")


@pytest.mark.parametrize(
    ("axis", "size", "is_of_tool", "wanted"),
    [
        (2, 0.001, False, [0.3, 0.0, 0.501, 1.0, 0.0, 0.0, 0.0]),
        (2, 0.001, True, [0.3, 0.0, 0.499, 1.0, 0.0, 0.0, 0.0]),
        (1, 0.001, True, [0.3, -0.001, 0.5, 1.0, 0.0, 0.0, 0.0]),
        (0, -0.001, True, [0.299, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]),
        (5, QUARTER, False, [0.3, 0.0, 0.5, HALF, HALF, 0.0, 0.0]),
        (5, QUARTER, True, [0.3, 0.0, 0.5, HALF, -HALF, 0.0, 0.0]),
    ],
)
def test_a_step_goes_along_and_about_the_axes_of_base_or_tool(
    desk, axis, size, is_of_tool, wanted
):
    _looking_down(desk)
    assert _step(desk, axis, size, 0.0, is_of_tool=is_of_tool) == ""
    assert desk.step(0.1).values == pytest.approx(wanted, abs=1e-12)


def test_steps_that_follow_each_other_add_up_and_late_ones_begin_anew(desk):
    _looking_down(desk)
    for now in (0.0, 0.1, 0.2):
        _step(desk, 2, -0.001, now)
    assert desk.step(0.3).values[2] == pytest.approx(0.497)
    _step(desk, 2, -0.001, 0.3 + STEPS_ADD_UP)
    assert desk.step(2.0).values[2] == pytest.approx(0.499)
    desk.go([0.4, 0.0, 0.5], 2.1)
    _step(desk, 0, 0.001, 2.2)
    assert desk.step(2.3).values[0] == pytest.approx(0.301)


def test_a_full_turn_of_many_steps_comes_back(desk):
    _looking_down(desk)
    for i in range(360):
        _step(desk, 4, math.radians(1.0), i / 100, is_of_tool=i % 2 == 0)
    for i in range(360):
        _step(desk, 4, math.radians(-1.0), 4 + i / 100, is_of_tool=i % 2 == 1)
    back = desk.step(8.0).values
    assert distance(back, DOWN) < 1e-6
    assert math.hypot(*back[3:]) == pytest.approx(1.0, abs=1e-12)


def test_a_step_without_a_controller_is_refused(desk):
    desk.refresh(view())
    assert _step(desk, 0, 0.001, 0.0) != ""
    assert desk.step(0.1) is None


def test_the_place_is_what_the_hand_is_told_else_where_it_is(desk):
    tool = Pose.from_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6))
    arms = {"panda": ArmFacts(Pose(), Pose(), None, tool)}
    desk.refresh(_view(TWIST, arms=arms))
    assert desk.state()["place"] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    desk.refresh(
        _view(
            POSE, arms=arms, samples={"hand": HERE.model_copy(update={"desired": DOWN})}
        )
    )
    assert desk.state()["place"] == pytest.approx([0.3, 0.0, 0.5, math.pi, 0.0, 0.0])
