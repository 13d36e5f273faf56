"""The state of the link, and when nothing may be commanded."""

from dataclasses import replace

import pytest

from station.ui.link.station_view import StationView
from tests.ui.views import arm, controller, element, sample, status, view


@pytest.mark.parametrize(
    ("age", "link"), [(0.0, "live"), (0.6, "live"), (1.0, "stale"), (9.0, "lost")]
)
def test_link_follows_the_age_of_the_data(age, link):
    assert view(age=age).link == link


def test_link_is_lost_before_the_first_answer():
    assert (StationView().link, StationView().age) == ("lost", None)


def test_age_is_never_negative():
    assert view(age=-0.1).age == 0.0


@pytest.mark.parametrize(
    ("seen", "word"),
    [
        (view(age=9.0), "lost"),
        (view(stop_state="stopped"), "stopped"),
        (view(stop_state="released"), "not allowed yet"),
        (StationView(now=1.0, heard_at=1.0), "not known yet"),
    ],
)
def test_blocked_says_why(seen, word):
    assert word in seen.blocked()


def test_nothing_is_blocked_on_a_live_armed_station():
    assert view().blocked() == ""


@pytest.mark.parametrize(
    ("stop_state", "stopped"), [("armed", False), ("stopped", True), ("released", True)]
)
def test_the_robot_is_stopped_until_motion_is_allowed(stop_state, stopped):
    assert view(stop_state=stop_state).is_stopped is stopped
    assert not StationView().is_stopped


def _running(unit="rad", kind="family/Kind"):
    held = controller("arm", "running").model_copy(update={"type": kind})
    elements = (element("joint1", unit),) if unit else ()
    return view(
        held,
        elements={"arm": elements},
        samples={"arm": sample(1.0, desired=0.5, names=("joint1",))},
    )


@pytest.mark.parametrize(
    ("running", "commands"),
    [
        (_running(), {"joint1": 0.5}),
        (_running("Nm"), {}),
        (
            _running("", "position_controllers/JointTrajectoryController"),
            {"joint1": 0.5},
        ),
        (_running("", "joint_state_controller/JointStateController"), {}),
    ],
)
def test_only_controllers_of_positions_command_a_pose(running, commands):
    assert running.commanded_positions() == commands
    assert running.commanding_positions() == ({"arm"} if commands else set())


@pytest.mark.parametrize(
    ("claims", "arms"),
    [
        (["left_robot"], ("left",)),
        (["right_joint1", "right_joint2"], ("right",)),
        (["left_joint1", "right_joint1"], ("left", "right")),
        (["wheel"], ()),
    ],
)
def test_a_controller_is_of_the_arms_that_it_claims(claims, arms):
    robots = [arm(name, "idle") for name in ("left", "right")]
    seen = replace(view(), status=status(robots=robots))
    assert seen.arms_of(controller("it", joints=claims)) == arms
