"""Grippers through the facade: what is refused, and what a stop leaves."""

import pytest

from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.errors import (
    ArmNotFoundError,
    GripperNotFoundError,
    StoppedError,
)
from station.core.facade.grippers import Grippers
from station.core.franka import GraspRequest, GripperActivity
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.core.ports.goal import GoalStatus
from station.hw.mock import MockRobotHW
from tests.franka_station import make_franka_station
from tests.hw.franka.grasp_scene import WIDTH, make_grasp_station, run_until_done


@pytest.fixture
def station():
    return make_franka_station()


def no_hands() -> Grippers:
    parameters, clock, hw = Parameters(), ManualClock(), MockRobotHW()
    hw.init(parameters, parameters)
    manager = ControllerManager(hw, parameters, [TableLoader({})], clock)
    return Grippers(ControlLoop(hw, manager, clock=clock), ["bare"])


def test_an_unknown_arm_and_one_without_a_hand_are_told_apart(station):
    with pytest.raises(ArmNotFoundError, match="no arm 'left'"):
        station.grippers.state("left")
    with pytest.raises(GripperNotFoundError, match="Arm 'bare' has no gripper"):
        no_hands().state("bare")


def test_nothing_begins_while_the_station_is_stopped_but_stop_works(station):
    station.stop("test")
    station.loop.step()

    for begin in (
        lambda: station.grippers.homing("panda"),
        lambda: station.grippers.move("panda", 0.0),
        lambda: station.grippers.grasp("panda", GraspRequest(0.03, 20.0)),
    ):
        with pytest.raises(StoppedError):
            begin()
    assert station.grippers.stop("panda").activity is GripperActivity.IDLE


def test_a_stop_ends_a_motion_with_its_reason(station):
    station.grippers.move("panda", 0.0)
    station.loop.step(300)
    station.stop("somebody is in the cell")
    station.loop.step()
    width = station.grippers.state("panda").width
    station.loop.step(500)
    state = station.grippers.state("panda")

    assert state.last.status is GoalStatus.PREEMPTED
    assert "somebody is in the cell" in state.last.message
    assert state.width == pytest.approx(width, abs=1e-3)


@pytest.mark.parametrize("pressed", [True, False])
def test_the_user_stop_ends_a_motion(station, pressed):
    station.robots.set_user_stop("panda", pressed=not pressed)
    station.grippers.move("panda", 0.0)
    station.robots.set_user_stop("panda", pressed=pressed)

    assert "user stop" in station.grippers.state("panda").last.message


def test_what_is_grasped_stays_grasped():
    station = make_grasp_station()
    station.grippers.grasp("panda", GraspRequest(WIDTH, 20.0))
    run_until_done(station)

    station.robots.set_user_stop("panda", pressed=True)
    station.stop("test")
    station.loop.step(500)
    state = station.grippers.state("panda")

    assert state.is_grasped
    assert state.force == pytest.approx(-20.0)


def test_an_arm_in_reflex_has_a_hand_that_works(station):
    station.robots.set_user_stop("panda", pressed=True)
    station.grippers.move("panda", 0.02)

    assert run_until_done(station).last.status is GoalStatus.SUCCEEDED


def test_time_and_motion_stand_still_with_the_simulation(station):
    station.grippers.move("panda", 0.02)
    before = station.grippers.state("panda")

    station.loop._idle()

    assert station.grippers.state("panda") == before
