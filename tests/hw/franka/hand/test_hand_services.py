"""A simulated hand moves, grasps a real box and lets go of it."""

import pytest

from station.core.control.switching import SwitchRequest
from station.core.errors import GripperCommandError, InvalidCommandError
from station.core.franka import GraspRequest, GripperActivity
from station.core.franka.arms import Arms
from station.core.franka.gripper_services import Grippers
from station.core.ports.goal import GoalStatus
from tests.franka_station import make_franka_station
from tests.hw.franka.grasp_scene import (
    WIDTH,
    box_height,
    contact_force,
    make_grasp_station,
    run_until_done,
)

HAND = "effort_controllers/GripperActionController"
FINGER = {
    "joint": "panda_finger_joint1",
    "gains": {"panda_finger_joint1": {"p": 100.0}},
}


@pytest.fixture
def station():
    return make_grasp_station()


@pytest.fixture
def empty():
    """Return a station with nothing between the fingers."""
    return make_franka_station()


def grasp(station, width=WIDTH, force=20.0, **more):
    Grippers(station.robots).grasp("panda", GraspRequest(width, force, **more))
    return run_until_done(station)


def test_the_gripper_begins_open_and_idle(empty):
    state = Grippers(empty.robots).state("panda")

    assert state.width == pytest.approx(0.08, abs=1e-4)
    assert (state.activity, state.is_grasped) == (GripperActivity.IDLE, False)
    assert state.command is state.last is None


def test_the_gripper_moves_to_a_width_at_the_requested_speed(empty):
    Grippers(empty.robots).move("panda", 0.02, 0.05)
    begun = Grippers(empty.robots).state("panda")
    state = run_until_done(empty)
    empty.loop.step(200)

    assert begun.command.status is GoalStatus.ACTIVE
    assert state.last.status is GoalStatus.SUCCEEDED
    assert state.last.ended - state.last.started == pytest.approx(1.2, abs=0.05)
    assert Grippers(empty.robots).state("panda").width == pytest.approx(0.02, abs=1e-4)


def test_homing_measures_the_largest_width(empty):
    Grippers(empty.robots).homing("panda")
    state = run_until_done(empty, 10_000)

    assert state.last.status is GoalStatus.SUCCEEDED
    assert state.max_width == pytest.approx(0.08, abs=1e-3)
    assert state.width == pytest.approx(0.08, abs=1e-3)
    # 0.08 m there and back at 0.02 m/s, and a rest at each end.
    assert state.last.ended - state.last.started == pytest.approx(8.2, abs=0.1)


@pytest.mark.parametrize("force", [5.0, 20.0, 70.0, 140.0])
def test_the_box_is_pressed_with_the_force_of_the_grasp(station, force):
    state = grasp(station, force=force)
    station.loop.step(300)

    assert (state.activity, state.is_grasped) == (GripperActivity.HOLDING, True)
    # Soft contacts give way: at 140 N by less than a fifth of a millimetre.
    assert Grippers(station.robots).state("panda").width == pytest.approx(
        WIDTH, abs=2e-4
    )
    for finger in ("panda_leftfinger", "panda_rightfinger"):
        assert contact_force(station, finger) == pytest.approx(force, rel=0.01)


@pytest.mark.parametrize(
    ("width", "inner", "outer", "succeeds"),
    [
        (0.03, 0.005, 0.005, True),
        (0.026, 0.0, 0.005, True),
        (0.024, 0.01, 0.005, False),
        (0.034, 0.005, 0.0, True),
        (0.036, 0.005, 0.01, False),
    ],
)
def test_only_the_expected_width_is_grasped(station, width, inner, outer, succeeds):
    state = grasp(station, width, epsilon_inner=inner, epsilon_outer=outer)

    expected = GoalStatus.SUCCEEDED if succeeds else GoalStatus.ABORTED
    assert state.last.status is expected
    assert state.is_grasped is succeeds
    if not succeeds:
        assert "came to rest at 0.03" in state.last.message
        station.loop.step(500)
        assert contact_force(station, "panda_leftfinger") < 0.1


def test_a_grasp_ends_soon_after_the_fingers_touch(station):
    grasp(station)
    touched = (
        Grippers(station.robots).state("panda").last.started + (0.08 - WIDTH) / 0.1
    )

    assert Grippers(station.robots).state("panda").last.ended - touched < 0.2


def test_a_grasp_of_air_is_aborted(empty):
    state = grasp(empty)

    assert state.last.status is GoalStatus.ABORTED
    assert state.activity is GripperActivity.IDLE
    assert state.width == pytest.approx(0.0, abs=1e-3)


def test_a_grasp_that_opens_ends(empty):
    Grippers(empty.robots).move("panda", 0.0)
    run_until_done(empty)

    state = grasp(empty, 0.05)

    assert state.last.status is GoalStatus.ABORTED
    assert state.width == pytest.approx(0.08, abs=1e-3)


def test_a_move_that_is_blocked_is_aborted_and_does_not_press(station):
    Grippers(station.robots).move("panda", 0.0)
    state = run_until_done(station)
    station.loop.step(500)

    assert state.last.status is GoalStatus.ABORTED
    assert "blocks the fingers at 0.0" in state.last.message
    assert contact_force(station, "panda_leftfinger") < 0.1


def test_grasping_again_changes_the_force_and_does_not_let_go(station):
    grasp(station, force=10.0)
    station.loop.step(100)
    Grippers(station.robots).grasp("panda", GraspRequest(WIDTH, 40.0))
    widest = 0.0
    for _ in range(400):
        station.loop.step()
        widest = max(widest, Grippers(station.robots).state("panda").width)

    assert widest < WIDTH + 1e-3
    assert contact_force(station, "panda_leftfinger") == pytest.approx(40.0, rel=0.01)


def test_a_new_gripper_command_ends_the_command_before(empty):
    Grippers(empty.robots).move("panda", 0.0)
    empty.loop.step(300)
    state = Grippers(empty.robots).move("panda", 0.08)

    assert state.command.identifier == 2
    assert (state.last.identifier, state.last.status) == (1, GoalStatus.PREEMPTED)
    assert run_until_done(empty).width == pytest.approx(0.08, abs=2e-3)


def test_stop_stops_within_a_millimetre(empty):
    Grippers(empty.robots).move("panda", 0.0)
    empty.loop.step(300)
    state = Grippers(empty.robots).stop("panda")
    empty.loop.step(1_000)

    assert state.last.status is GoalStatus.PREEMPTED
    assert state.command is None
    assert Grippers(empty.robots).state("panda").width == pytest.approx(
        state.width, abs=1e-3
    )


def test_stop_with_nothing_running_changes_nothing(empty):
    assert Grippers(empty.robots).stop("panda").last is None
    empty.loop.step(300)
    assert Grippers(empty.robots).state("panda").width == pytest.approx(0.08, abs=1e-4)


def test_stop_lets_go(station):
    grasp(station)
    state = Grippers(station.robots).stop("panda")
    station.loop.step(500)

    assert not state.is_grasped
    assert contact_force(station, "panda_leftfinger") < 0.1


def lift(station):
    """Raise the hand with what it holds, in 2 s."""
    start = list(Arms(station.robots).state("panda").q)
    for cycle in range(2_000):
        part = (cycle + 1) / 2_000
        goal = list(start)
        goal[1] -= 0.2 * part * part * (3.0 - 2.0 * part)
        station.motion.set_command("arm", goal, timeout=0.0)
        station.loop.step()


@pytest.mark.long
@pytest.mark.parametrize(("mass", "force"), [(0.5, 20.0), (1.5, 60.0)])
def test_what_is_held_does_not_creep(mass, force):
    """0.5 kg are an eighth of what friction carries; with soft friction they sink."""
    station = make_grasp_station(mass=mass)
    station.switch_controllers(SwitchRequest(["arm"]))
    grasp(station, force=force)
    lift(station)
    station.loop.step(1_000)
    held = box_height(station)
    station.loop.step(10_000)

    assert Grippers(station.robots).state("panda").is_grasped
    assert box_height(station) == pytest.approx(held, abs=1e-4)


def test_a_stop_of_the_station_does_not_drop_a_lifted_box(station):
    station.switch_controllers(SwitchRequest(["arm"]))
    grasp(station, force=20.0)
    low, hand = box_height(station), Arms(station.robots).state("panda").O_T_EE[14]
    lift(station)
    station.stop("test")
    station.loop.step(500)

    risen = box_height(station) - low
    assert risen > 0.05
    way = Arms(station.robots).state("panda").O_T_EE[14] - hand
    assert risen == pytest.approx(way, abs=1e-3)
    assert Grippers(station.robots).state("panda").is_grasped


def test_the_arm_holds_still_while_the_hand_works(empty):
    empty.switch_controllers(SwitchRequest(["arm"]))
    before = Arms(empty.robots).state("panda").q
    grasp(empty)

    assert Arms(empty.robots).state("panda").q == pytest.approx(before, abs=1e-4)


def test_a_reset_ends_the_motion_and_opens_the_hand(station):
    grasp(station)
    Grippers(station.robots).move("panda", 0.0)
    station.simulation.reset({})
    station.loop.step(500)
    state = Grippers(station.robots).state("panda")

    assert state.last.status is GoalStatus.PREEMPTED
    assert state.width == pytest.approx(0.08, abs=1e-4)
    assert not state.is_grasped


def test_a_controller_that_takes_the_fingers_wins(empty):
    empty.load_controller("hand", HAND, FINGER)
    Grippers(empty.robots).move("panda", 0.0)
    empty.loop.step(100)
    empty.switch_controllers(SwitchRequest(["hand"]))
    state = Grippers(empty.robots).state("panda")

    assert state.activity is GripperActivity.CONTROLLED
    assert state.last.status is GoalStatus.PREEMPTED
    assert "'hand'" in state.last.message
    for command in (
        lambda: Grippers(empty.robots).homing("panda"),
        lambda: Grippers(empty.robots).move("panda", 0.0),
        lambda: grasp(empty),
    ):
        with pytest.raises(GripperCommandError, match="controller 'hand' claims"):
            command()
    assert Grippers(empty.robots).stop("panda").activity is GripperActivity.CONTROLLED

    empty.switch_controllers(SwitchRequest((), ["hand"]))
    assert Grippers(empty.robots).move("panda", 0.02).command is not None


@pytest.mark.parametrize(
    ("numbers", "field"),
    [
        ({"width": 0.08}, "width"),
        ({"width": -0.01}, "width"),
        ({"force": 0.0}, "force"),
        ({"force": 141.0}, "force"),
        ({"speed": 0.0}, "speed"),
        ({"speed": 0.5}, "speed"),
        ({"epsilon_inner": -0.001}, "epsilon/inner"),
        ({"epsilon_outer": float("inf")}, "epsilon/outer"),
        ({"width": float("nan")}, "width"),
    ],
)
def test_numbers_out_of_range_are_refused_and_change_no_setting(empty, numbers, field):
    Grippers(empty.robots).move("panda", 0.0)
    request = GraspRequest(**{"width": 0.03, "force": 20.0, **numbers})

    with pytest.raises(InvalidCommandError, match="allowed is") as caught:
        Grippers(empty.robots).grasp("panda", request)

    assert caught.value.details["errors"][0]["field"] == f"body/{field}"
    assert Grippers(empty.robots).state("panda").command.identifier == 1


@pytest.mark.parametrize(("width", "speed"), [(0.081, 0.1), (-0.01, 0.1), (0.01, 0.0)])
def test_impossible_moves_are_refused(empty, width, speed):
    with pytest.raises(InvalidCommandError):
        Grippers(empty.robots).move("panda", width, speed)
