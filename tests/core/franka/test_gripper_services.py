"""Which widths a grasp expects.

Grippers through the facade: what is refused, and what a stop leaves.
"""

import pytest

from station.core.errors import (
    ArmNotFoundError,
    GripperNotFoundError,
    StoppedError,
)
from station.core.franka import GraspRequest, GripperActivity
from station.core.franka.arms import Arms
from station.core.franka.gripper_services import Grippers
from station.core.ports.goal import GoalStatus
from tests.franka_station import make_franka_station
from tests.hw.franka.grasp_scene import WIDTH, make_grasp_station, run_until_done
from tests.swing_station import make_swing_station


@pytest.mark.parametrize(
    ("width", "accepted"),
    [(0.03, True), (0.0251, True), (0.0249, False), (0.0349, True), (0.0351, False)],
)
def test_the_tolerance_is_half_a_centimetre_unless_told_otherwise(width, accepted):
    assert GraspRequest(0.03, 20.0).accepts(width) is accepted


def test_both_sides_have_their_own_tolerance():
    request = GraspRequest(0.03, 20.0, epsilon_inner=0.001, epsilon_outer=0.02)

    assert not request.accepts(0.028)
    assert request.accepts(0.045)


@pytest.fixture
def station():
    return make_franka_station()


def test_an_unknown_arm_and_one_without_a_hand_are_told_apart(station):
    with pytest.raises(ArmNotFoundError, match="no arm 'left'"):
        Grippers(station.robots).state("left")
    with pytest.raises(GripperNotFoundError, match="Arm 'swing' has no gripper"):
        Grippers(make_swing_station().robots).state("swing")


def test_nothing_begins_while_the_station_is_stopped_but_stop_works(station):
    station.stop("test")
    station.loop.step()

    for begin in (
        lambda: Grippers(station.robots).homing("panda"),
        lambda: Grippers(station.robots).move("panda", 0.0),
        lambda: Grippers(station.robots).grasp("panda", GraspRequest(0.03, 20.0)),
    ):
        with pytest.raises(StoppedError):
            begin()
    assert Grippers(station.robots).stop("panda").activity is GripperActivity.IDLE


def test_a_stop_ends_a_motion_with_its_reason(station):
    Grippers(station.robots).move("panda", 0.0)
    station.loop.step(300)
    station.stop("somebody is in the cell")
    station.loop.step()
    width = Grippers(station.robots).state("panda").width
    station.loop.step(500)
    state = Grippers(station.robots).state("panda")

    assert state.last.status is GoalStatus.PREEMPTED
    assert "somebody is in the cell" in state.last.message
    assert state.width == pytest.approx(width, abs=1e-3)


@pytest.mark.parametrize("pressed", [True, False])
def test_the_user_stop_ends_a_motion(station, pressed):
    Arms(station.robots).set_user_stop("panda", pressed=not pressed)
    Grippers(station.robots).move("panda", 0.0)
    Arms(station.robots).set_user_stop("panda", pressed=pressed)

    assert "user stop" in Grippers(station.robots).state("panda").last.message


def test_what_is_grasped_stays_grasped():
    station = make_grasp_station()
    Grippers(station.robots).grasp("panda", GraspRequest(WIDTH, 20.0))
    run_until_done(station)

    Arms(station.robots).set_user_stop("panda", pressed=True)
    station.stop("test")
    station.loop.step(500)
    state = Grippers(station.robots).state("panda")

    assert state.is_grasped
    assert state.force == pytest.approx(-20.0)


def test_an_arm_in_reflex_has_a_hand_that_works(station):
    Arms(station.robots).set_user_stop("panda", pressed=True)
    Grippers(station.robots).move("panda", 0.02)

    assert run_until_done(station).last.status is GoalStatus.SUCCEEDED


def test_time_and_motion_stand_still_with_the_simulation(station):
    Grippers(station.robots).move("panda", 0.02)
    before = Grippers(station.robots).state("panda")

    station.loop.control_cycle.run_standstill()

    assert Grippers(station.robots).state("panda") == before
