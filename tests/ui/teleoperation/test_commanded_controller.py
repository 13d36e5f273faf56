"""The controller that takes set-points, or why there is none."""

from dataclasses import replace

import pytest

from station.ui.link.station_view import POSE, TWIST
from station.ui.teleoperation.commanded_controller import (
    arms_to_move,
    choose_for_hand,
    choose_for_joints,
)
from station.wire import ControllerType
from tests.ui.views import arm, controller, element, status, view

ARMS = ("left", "right")
KIND = "CartesianJogController"


def jog(state="running"):
    kind = f"franka_controllers/{KIND}"
    return controller("jog", state).model_copy(update={"type": kind})


def elements(names):
    return {"jog": tuple(element(name) for name in names)}


def test_the_running_controller_with_the_elements_is_chosen():
    chosen = choose_for_hand(view(jog(), elements=elements(TWIST)), TWIST, KIND)

    assert (chosen.name, chosen.reason) == ("jog", "")


def test_another_kind_of_set_point_is_not():
    chosen = choose_for_hand(view(jog(), elements=elements(POSE)), TWIST, KIND)

    assert chosen.name == ""


@pytest.mark.parametrize("arm_id", ["left", "right"])
def test_the_controller_of_the_arm_is_chosen(arm_id):
    running = [controller(f"{a}_jog", "running", (f"{a}_robot",)) for a in ARMS]
    names = tuple(element(name) for name in TWIST)
    seen = view(*running, elements={one.name: names for one in running})
    seen = replace(seen, status=status(robots=[arm(a, "idle") for a in ARMS]))

    assert choose_for_hand(seen, TWIST, KIND, arm_id).name == f"{arm_id}_jog"
    assert arms_to_move(seen) == list(ARMS)


def test_what_to_load_names_the_arm():
    types = (ControllerType(type=f"a/{KIND}", base_class="C"),)
    reason = choose_for_hand(view(types=types), TWIST, KIND, "left").reason
    assert reason.startswith(f"Load a {KIND} of left")


@pytest.mark.parametrize(
    ("station", "reason"),
    [
        (view(jog("stopped")), "Start jog in the dock Controllers."),
        (view(jog(), stop_state="stopped"), "The robot is stopped."),
        (view(age=9.0), "The link to the station is"),
        (view(), f"This station has no {KIND}."),
        (
            view(types=(ControllerType(type=f"a/{KIND}", base_class="C"),)),
            f"Load a {KIND} in the dock Controllers",
        ),
    ],
)
def test_the_reason_names_the_remedy(station, reason):
    assert choose_for_hand(station, TWIST, KIND).reason.startswith(reason)


def test_the_running_controller_with_set_points_is_commanded():
    seen = view(
        controller("state", "running"),
        controller("arm", "running"),
        elements={"state": (), "arm": (element(),)},
    )
    operated = choose_for_joints(seen)[0]
    assert (operated.name, operated.reason) == ("arm", "")


def test_sliders_name_the_running_controllers_when_none_takes_set_points():
    operated = choose_for_joints(view(controller("state", "running")))[0]
    assert operated.name == ""
    assert "Only state runs" in operated.reason


def test_sliders_say_that_the_robot_is_stopped():
    seen = view(
        controller("arm", "running"),
        stop_state="stopped",
        elements={"arm": (element(),)},
    )
    assert "stopped" in choose_for_joints(seen)[0].reason


def test_sliders_are_not_for_the_end_effector():
    running = view(
        controller("jog", "running"), elements={"jog": (element("vx", "m/s"),)}
    )

    chosen = choose_for_joints(running)[0]
    assert chosen.name == ""
    assert chosen.reason.startswith("jog moves the end effector")
