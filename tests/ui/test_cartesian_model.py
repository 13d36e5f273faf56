"""Held buttons, a dragged target, and why there is nothing to move."""

from dataclasses import replace

import pytest

from station.ui.cartesian_model import (
    HELD_FOR,
    PATIENCE,
    POSE,
    TWIST,
    HeldButtons,
    TargetPose,
    arms_to_move,
    bases_of_hands,
    choose_cartesian,
    distance,
)
from station.wire import ControllerType
from tests.ui.views import arm, controller, element, status, view

ARMS = ("left", "right")
KIND = "CartesianJogController"
HERE = [0.3, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]
THERE = [0.4, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]


def jog(state="running"):
    kind = f"franka_controllers/{KIND}"
    return controller("jog", state).model_copy(update={"type": kind})


def elements(names):
    return {"jog": tuple(element(name) for name in names)}


def test_the_running_controller_with_the_elements_is_chosen():
    chosen = choose_cartesian(view(jog(), elements=elements(TWIST)), TWIST, KIND)

    assert (chosen.name, chosen.reason) == ("jog", "")


def test_another_kind_of_set_point_is_not():
    chosen = choose_cartesian(view(jog(), elements=elements(POSE)), TWIST, KIND)

    assert chosen.name == ""


@pytest.mark.parametrize("arm_id", ["left", "right"])
def test_the_controller_of_the_arm_is_chosen(arm_id):
    running = [controller(f"{a}_jog", "running", (f"{a}_robot",)) for a in ARMS]
    names = tuple(element(name) for name in TWIST)
    seen = view(*running, elements={one.name: names for one in running})
    seen = replace(seen, status=status(robots=[arm(a, "idle") for a in ARMS]))

    assert choose_cartesian(seen, TWIST, KIND, arm_id).name == f"{arm_id}_jog"
    assert arms_to_move(seen) == list(ARMS)


def test_what_to_load_names_the_arm():
    types = (ControllerType(type=f"a/{KIND}", base_class="C"),)
    reason = choose_cartesian(view(types=types), TWIST, KIND, "left").reason
    assert reason.startswith(f"Load a {KIND} of left")


@pytest.mark.parametrize(
    ("arms", "bases", "expected"),
    [
        ([], [], {"": ""}),
        (["panda"], ["/robot/a"], {"": "/robot/a"}),
        (ARMS, ["/robot/a", "/robot_2/a"], {"left": "/robot/a", "right": "/robot_2/a"}),
        (ARMS, ["/robot/a"], {"left": "/robot/a", "right": ""}),
    ],
)
def test_each_target_is_drawn_at_the_base_of_its_arm(arms, bases, expected):
    assert bases_of_hands(arms, bases) == expected


@pytest.mark.parametrize(
    ("station", "reason"),
    [
        (view(jog("stopped")), "Start jog in the Controllers tab."),
        (view(jog(), stop_state="stopped"), "The robot is stopped."),
        (view(age=9.0), "The link to the station is"),
        (view(), f"This station has no {KIND}."),
        (
            view(types=(ControllerType(type=f"a/{KIND}", base_class="C"),)),
            f"Load a {KIND} in the Controllers tab",
        ),
    ],
)
def test_the_reason_names_the_remedy(station, reason):
    assert choose_cartesian(station, TWIST, KIND).reason.startswith(reason)


def test_a_held_button_counts_for_a_moment_and_ends_with_one_zero():
    buttons = HeldButtons()
    buttons.hold(1, -1, now=5.0)

    assert buttons.twist(5.0 + 0.9 * HELD_FOR, 0.1, 0.4) == [0.0, -0.1, 0, 0, 0, 0]
    assert buttons.twist(5.0 + 1.1 * HELD_FOR, 0.1, 0.4) == [0.0] * 6
    assert buttons.twist(5.0 + 1.2 * HELD_FOR, 0.1, 0.4) is None


def test_a_button_that_was_let_go_ends_at_once():
    buttons = HeldButtons()
    buttons.hold(2, 1, now=0.0)
    buttons.twist(0.0, 0.1, 0.4)
    buttons.release(2, 1)

    assert buttons.twist(0.01, 0.1, 0.4) == [0.0] * 6


def test_several_buttons_share_the_speed():
    buttons = HeldButtons()
    for axis in (0, 1, 5):
        buttons.hold(axis, 1, now=0.0)

    twist = buttons.twist(0.0, 0.1, 0.4)
    assert twist == pytest.approx([0.0707, 0.0707, 0, 0, 0, 0.4], abs=1e-4)


def test_letting_go_forgets_everything():
    buttons = HeldButtons()
    buttons.hold(0, 1, now=0.0)
    buttons.twist(0.0, 0.1, 0.4)
    buttons.let_go()

    assert buttons.twist(0.0, 0.1, 0.4) is None


def test_a_target_is_sent_until_the_arm_is_there():
    target = TargetPose()
    assert target.command(HERE, now=0.0) is None
    target.drag(THERE, now=0.0)

    assert target.command(HERE, now=0.1) == THERE
    assert target.is_pursued
    assert target.command(THERE, now=0.2) == THERE
    assert not target.is_pursued


def test_a_target_that_comes_no_nearer_is_given_up():
    target = TargetPose()
    target.drag(THERE, now=0.0)
    target.command(HERE, now=0.0)

    target.command(HERE, now=0.9 * PATIENCE)
    assert target.is_pursued
    target.command(HERE, now=1.1 * PATIENCE)
    assert not target.is_pursued


def test_a_quaternion_and_its_negative_are_no_distance_apart():
    assert distance(HERE, [*HERE[:3], -1.0, 0.0, 0.0, 0.0]) == 0.0
    assert distance(HERE, THERE) == pytest.approx(0.1)
