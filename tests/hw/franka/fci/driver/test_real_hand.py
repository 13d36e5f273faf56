"""The driver's hand, with a simulated hand behind the server's session."""

from math import isnan

import pytest

from station.core.errors import GripperLostError, InvalidCommandError
from station.core.franka import GraspRequest, GripperAction, GripperActivity
from station.core.hardware.interfaces import JointStateInterface
from station.core.ports.goal import GoalStatus
from station.hw.franka.fci.driver.hand_link import RETRY
from station.hw.franka.fci.driver.network import UDP_TIMEOUT
from station.hw.franka.fci.wire.gripper_protocol import HandCommand
from tests.hw.franka.fci.hand_network import SteppedHand


@pytest.fixture
def unconnected():
    """A hand that the driver has not connected to yet."""
    made = SteppedHand()
    yield made
    made.link.close()


@pytest.fixture
def bench(unconnected):
    """A hand that the driver has connected to."""
    unconnected.link.serve_orders()
    return unconnected


def test_state_is_that_of_the_hand(bench):
    state = bench.hand.get_state()
    assert state.width == pytest.approx(0.08, abs=1e-4)
    assert state.max_width == pytest.approx(0.08)
    assert state.activity is GripperActivity.IDLE
    assert isnan(state.force)
    before = state.time
    bench.turns(3)
    assert bench.hand.get_state().time > before


def test_move_begins_at_once_and_succeeds_when_it_has_arrived(bench):
    bench.hand.move(0.05, 0.2)
    begun = bench.hand.get_state()
    assert begun.activity is GripperActivity.MOVING
    assert begun.command.request == {"width": 0.05, "speed": 0.2}
    last = bench.turn_until_over()
    assert (last.status, last.message) == (GoalStatus.SUCCEEDED, "")
    assert last.ended > last.started
    bench.turns(10)
    assert bench.hand.get_state().width == pytest.approx(0.05, abs=1e-3)


def test_homing_succeeds(bench):
    bench.hand.homing()
    assert bench.hand.get_state().activity is GripperActivity.HOMING
    for _ in range(3):
        last = bench.turn_until_over()
    assert (last.action, last.status) == (GripperAction.HOMING, GoalStatus.SUCCEEDED)


def test_grasp_of_air_is_aborted_with_where_the_fingers_came_to_rest(bench):
    bench.hand.grasp(GraspRequest(width=0.03, force=20.0, speed=0.4))
    last = bench.turn_until_over()
    assert last.status is GoalStatus.ABORTED
    assert last.message == (
        "The fingers came to rest at 0.0000 m, where they should not."
    )
    assert bench.hand.get_state().activity is GripperActivity.IDLE


def test_newer_command_stops_the_older_one_first(bench):
    bench.hand.move(0.0, 0.05)
    bench.turns(5)
    bench.hand.move(0.07, 0.2)
    last = bench.hand.get_state().last
    assert last.status is GoalStatus.PREEMPTED
    assert "A newer command took over: move" in last.message
    assert bench.turn_until_over().status is GoalStatus.SUCCEEDED
    assert bench.requests[-3:] == [
        HandCommand.MOVE,
        HandCommand.STOP,
        HandCommand.MOVE,
    ]
    assert bench.hand.get_state().width == pytest.approx(0.07, abs=2e-3)


def test_stop_ends_a_motion(bench):
    bench.hand.move(0.0, 0.05)
    bench.turns(5)
    bench.hand.stop()
    state = bench.hand.get_state()
    assert state.command is None
    assert state.last.status is GoalStatus.PREEMPTED
    bench.turns(20)
    width = bench.hand.get_state().width
    assert width > 0.05
    bench.turns(10)
    assert bench.hand.get_state().width == pytest.approx(width, abs=1e-3)


def test_interrupt_ends_a_motion_and_nothing_else(bench):
    sent = len(bench.requests)
    bench.hand.interrupt("The station was stopped.")
    bench.turns(2)
    assert len(bench.requests) == sent
    bench.hand.move(0.0, 0.05)
    bench.turns(3)
    bench.hand.interrupt("The station was stopped.")
    assert bench.hand.get_state().last.message == "The station was stopped."
    bench.turns(2)
    assert bench.requests[-1] == HandCommand.STOP


def test_command_that_the_hand_refuses_is_told_in_libfrankas_words(bench):
    bench.robot.give_to("another_program")
    bench.hand.move(0.05, 0.2)
    last = bench.turn_until_over()
    assert last.status is GoalStatus.ABORTED
    assert last.message == "libfranka gripper: Command failed!"


def test_impossible_numbers_are_refused_before_they_are_sent(bench):
    sent = len(bench.requests)
    with pytest.raises(InvalidCommandError, match=r"0\.2; allowed is 0 to 0\.08 m"):
        bench.hand.move(0.2)
    with pytest.raises(InvalidCommandError, match="'force' 500"):
        bench.hand.grasp(GraspRequest(width=0.03, force=500.0))
    bench.turns(2)
    assert len(bench.requests) == sent


def test_absent_hand_is_told_and_found_when_it_is_there(unconnected):
    bench = unconnected
    bench.is_absent = True
    bench.link.serve_orders()
    for refused in (bench.hand.get_state, bench.hand.homing, bench.hand.stop):
        with pytest.raises(GripperLostError, match="FCI refused at h:1338") as error:
            refused()
    assert "end effector in Desk" in error.value.remedy

    bench.is_absent = False
    bench.turns(2)  # the rest of the time between two attempts, and an attempt
    assert bench.time == pytest.approx(RETRY, abs=0.1)
    assert bench.hand.get_state().width == pytest.approx(0.08, abs=1e-4)


@pytest.mark.parametrize("fault", ["is_silent", "is_broken"])
def test_lost_hand_ends_its_command_and_is_connected_again(bench, fault):
    bench.hand.move(0.0, 0.02)
    bench.turns(3)
    bench.is_absent = True
    setattr(bench, fault, True)
    bench.hand.stop()
    bench.turns(round(UDP_TIMEOUT / 0.02) + 2)
    with pytest.raises(GripperLostError, match=r"Timeout|broken pipe|refused"):
        bench.hand.move(0.05)

    bench.is_absent = False
    setattr(bench, fault, False)
    bench.turns(3)
    assert bench.hand.get_state().command is None
    bench.hand.move(0.05, 0.2)
    assert bench.turn_until_over().status is GoalStatus.SUCCEEDED


def test_command_of_a_hand_that_gets_lost_is_aborted_with_the_reason(bench):
    bench.hand.move(0.0, 0.02)
    bench.turns(3)
    bench.is_silent = True
    bench.turns(round(UDP_TIMEOUT / 0.02) + 2)
    bench.is_silent = False
    bench.turns(3)
    last = bench.hand.get_state().last
    assert last.status is GoalStatus.ABORTED
    assert last.message == "The hand was lost: libfranka: UDP receive: Timeout."


def test_fingers_are_in_the_joint_states_as_franka_gripper_publishes_them(bench):
    interface = JointStateInterface()
    bench.hand.register([interface, object()], ["panda_finger_joint1", "f2"])
    bench.turns(2)
    first = interface.get_handle("panda_finger_joint1")
    assert first.get_position() == pytest.approx(0.04, abs=1e-4)
    assert (first.get_velocity(), first.get_effort()) == (0.0, 0.0)


def test_command_that_cannot_be_sent_is_aborted_with_the_reason(bench):
    bench.is_broken = True
    bench.hand.move(0.05)
    bench.turns(1)
    bench.is_broken = False
    bench.turns(3)
    state = bench.hand.get_state()
    assert state.command is None
    assert state.last.status is GoalStatus.ABORTED
    assert "broken pipe" in state.last.message
