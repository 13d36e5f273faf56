"""What makes the robot move: only while armed, running, and in the present epoch."""

import pytest

from station.core.clock import ManualClock
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    ControllerStateError,
    GoalNotFoundError,
    InvalidCommandError,
    InvalidTrajectoryError,
    StaleEpochError,
    StoppedError,
)
from station.core.facade.station import Station
from station.core.ports.goal import GoalStatus
from tests.api.spring import make_station as make_spring_station
from tests.patient_clock import PatientClock
from tests.two_joint_station import TRAJECTORY, make_station

GOAL = {"trajectory": TRAJECTORY}


@pytest.fixture
def station() -> Station:
    """Return a station with a trajectory and a group controller, none running."""
    return make_station()


@pytest.fixture
def arm(station: Station) -> Station:
    """Return the same with the trajectory controller running."""
    station.switch_controllers(SwitchRequest(start=("arm",)))
    station.loop.step(3)
    return station


def positions(station: Station) -> list[float]:
    return list(station.latest().position)


def test_a_goal_is_reached_and_found_again(arm):
    goal = arm.motion.submit_goal("arm", GOAL)
    arm.loop.step(600)

    assert goal.status is GoalStatus.SUCCEEDED
    assert arm.motion.goals("arm") == [goal]
    assert arm.motion.goal("arm", goal.identifier) is goal
    assert positions(arm) == pytest.approx([0.4, -0.4], abs=1e-6)


def test_the_cycle_that_takes_a_set_point_up_is_noted(station):
    station.switch_controllers(SwitchRequest(start=("group",)))
    old, new = station.motion.ticket(), station.motion.ticket()
    station.motion.set_command("group", [0.1, 0.1], ticket=old)
    station.motion.set_command("group", [0.2, 0.2], ticket=new)
    assert station.motion.wait_for(new) is None  # nobody runs the loop

    station.loop.step(3)

    first = next(
        snapshot.cycle
        for snapshot in station.snapshots.read_since(0)[0]
        if (sample := snapshot.samples.get("group")) and sample.desired == [0.2, 0.2]
    )
    assert (old.accepted_cycle, new.accepted_cycle) == (None, first)


@pytest.fixture
def group(station):
    """Return the station with the group controller running."""
    station.switch_controllers(SwitchRequest(start=("group",)))
    station.loop.step()
    return station


def test_two_callers_that_move_different_joints_do_not_undo_each_other(group):
    at_rest = group.controller_sample("group").desired
    group.motion.set_command("group", [0.1, None])
    group.loop.step()
    assert list(group.motion.set_point("group").values) == [0.1, at_rest[1]]
    group.motion.set_command("group", [None, 0.2])
    group.motion.set_command("group", [0.3, None])  # before a cycle took the other up
    group.loop.step()
    assert list(group.motion.set_point("group").values) == [0.3, 0.2]


def test_an_element_is_not_left_at_a_set_point_that_a_stop_made_void(group):
    group.motion.set_command("group", [0.1, 0.1])
    group.stop("A test.")
    group.loop.step()
    group.release_stop(arm=False)
    group.release_stop(arm=True)
    group.switch_controllers(SwitchRequest(start=("group",)))
    group.loop.step()
    at_rest = group.controller_sample("group").desired
    group.motion.set_command("group", [None, 0.2])
    group.loop.step()
    assert list(group.motion.set_point("group").values) == [at_rest[0], 0.2]
    assert at_rest[0] != 0.1


def test_elements_are_left_out_by_none_alone(group):
    with pytest.raises(InvalidCommandError, match="leaves elements out"):
        group.motion.set_command("group", [None])


def test_the_cycle_that_takes_a_trajectory_up_is_noted(arm):
    ticket = arm.motion.ticket()
    arm.motion.follow_trajectory("arm", TRAJECTORY, ticket=ticket)

    arm.loop.step(3)

    assert ticket.accepted_cycle == arm.loop.cycle - 2


@pytest.mark.alone
def test_a_running_loop_is_waited_for():
    station = make_station(clock=PatientClock())
    station.switch_controllers(SwitchRequest(start=("group",)))
    station.loop.start()
    try:
        ticket = station.motion.ticket()
        before = station.loop.cycle
        station.motion.set_command("group", [0.1, 0.1], ticket=ticket)
        # Not before the cycle that was under way.
        assert station.motion.wait_for(ticket) >= before
        station.simulation.change(paused=True)
        ticket = station.motion.ticket()
        station.motion.set_command("group", [0.2, 0.2], ticket=ticket)
        assert station.motion.wait_for(ticket) is None
    finally:
        station.loop.stop()


def test_a_cancelled_goal_ends_and_the_joints_hold(arm):
    goal = arm.motion.submit_goal("arm", GOAL)
    arm.loop.step(200)
    arm.motion.cancel_goal("arm", goal.identifier)
    arm.loop.step(2)
    here = positions(arm)
    arm.loop.step(600)

    assert goal.status is GoalStatus.PREEMPTED
    assert positions(arm) == pytest.approx(here, abs=1e-9)
    with pytest.raises(GoalNotFoundError):
        arm.motion.cancel_goal("arm", "99")


def test_a_trajectory_is_followed_and_asked_about(arm):
    assert arm.motion.follow_trajectory("arm", TRAJECTORY) == arm.epoch
    arm.loop.step()

    later = arm.motion.query_state("arm", arm.loop.time + 1.0)
    assert later.position == pytest.approx([0.4, -0.4])
    assert arm.motion.query_state("arm").position == pytest.approx([0.0, 0.0], abs=1e-4)
    arm.loop.step(600)
    assert positions(arm) == pytest.approx([0.4, -0.4], abs=1e-6)


@pytest.mark.parametrize("time", [float("nan"), float("inf"), -1.0])
def test_impossible_times_are_refused(arm, time):
    with pytest.raises(InvalidTrajectoryError):
        arm.motion.query_state("arm", time)


SUBMISSIONS = [
    lambda station, epoch=None: station.motion.submit_goal("arm", GOAL, epoch),
    lambda station, epoch=None: station.motion.follow_trajectory(
        "arm", TRAJECTORY, epoch
    ),
]


@pytest.mark.parametrize("submit", SUBMISSIONS)
def test_nothing_starts_while_stopped_or_released(arm, submit):
    arm.stop("test")
    with pytest.raises(StoppedError):
        submit(arm)
    arm.release_stop(arm=False)
    with pytest.raises(StoppedError):
        submit(arm)


@pytest.mark.parametrize("submit", SUBMISSIONS)
def test_nothing_starts_in_a_controller_that_does_not_run(station, submit):
    with pytest.raises(ControllerStateError, match="initialized"):
        submit(station)


@pytest.mark.parametrize("submit", SUBMISSIONS)
def test_a_wish_of_an_older_epoch_is_refused(arm, submit):
    with pytest.raises(StaleEpochError):
        submit(arm, arm.epoch - 1)


@pytest.mark.parametrize("submit", SUBMISSIONS)
def test_a_new_epoch_voids_what_is_under_way(arm, submit):
    submit(arm)
    arm.loop.step(200)
    arm.loop.control_cycle.next_epoch("A reset.")  # as a reset or a recovery does
    arm.loop.step(2)
    here = positions(arm)
    arm.loop.step(600)

    assert here != pytest.approx([0.0, 0.0], abs=1e-3)
    assert positions(arm) == pytest.approx(here, abs=1e-9)
    assert all(goal.is_final() for goal in arm.motion.goals("arm"))


@pytest.mark.parametrize("submit", SUBMISSIONS)
def test_an_epoch_that_ends_during_the_check_voids_the_wish(arm, submit, monkeypatch):
    controller = arm.manager.get_controller("arm")
    real = controller.planner.plan

    def plan(*arguments, **options):
        arm.loop.control_cycle.next_epoch("A reset.")
        real(*arguments, **options)

    monkeypatch.setattr(controller.planner, "plan", plan)
    with pytest.raises(StaleEpochError):
        submit(arm)
    arm.loop.step(600)

    assert positions(arm) == pytest.approx([0.0, 0.0], abs=1e-9)
    assert all(goal.status is GoalStatus.PREEMPTED for goal in arm.motion.goals("arm"))


@pytest.mark.parametrize("command", [[0.1, 0.1], [0.1, None]])
def test_what_a_stop_has_ended_is_refused_as_stopped(station, command):
    station.switch_controllers(SwitchRequest(start=("group",)))
    station.loop.step(3)
    station.stop("a test")
    station.loop.step(1)

    with pytest.raises(StoppedError, match="a test"):
        station.motion.set_command("group", command)


def test_nothing_resumes_after_a_stop(arm):
    goal = arm.motion.submit_goal("arm", GOAL)
    arm.loop.step(200)
    arm.stop("test")
    arm.loop.step(2)
    here = positions(arm)
    arm.release_stop(arm=False)
    arm.release_stop(arm=True)
    arm.switch_controllers(SwitchRequest(start=("arm",)))
    arm.loop.step(600)

    assert goal.status is GoalStatus.PREEMPTED
    assert goal.result.message == "The station was stopped: test."
    assert positions(arm) == pytest.approx(here, abs=1e-3)


def test_controllers_without_a_port_say_so(station):
    with pytest.raises(ControllerStateError, match="'arm' is initialized"):
        make_station().motion.query_state("arm")
    for call in (station.motion.goals, station.motion.query_state):
        with pytest.raises(InvalidCommandError, match="'group' takes no"):
            call("group")
    with pytest.raises(InvalidCommandError, match="'arm' takes no set-points"):
        station.motion.set_point("arm")


def test_a_new_epoch_lets_set_point_controllers_rest(station):
    station.switch_controllers(SwitchRequest(start=("group",)))
    station.motion.set_command("group", [0.3, 0.3])
    station.loop.step(3)
    station.loop.hw.joints.mode[:] = ["", ""]  # as if moved from outside
    station.loop.hw.joints.position[:] = [0.1, 0.1]
    station.loop.step(2)

    station.loop.control_cycle.next_epoch("A reset.")
    station.loop.step(2)

    assert station.controller_sample("group").desired == [0.1, 0.1]


def test_a_goal_before_the_first_update_is_no_jump(station):
    station.load_controller(
        "gripper",
        "position_controllers/GripperActionController",
        {"joint": "j1", "goal_tolerance": 0.001},
    )
    station.switch_controllers(SwitchRequest(start=("gripper",)))
    goal = station.motion.submit_goal("gripper", {"command": {"position": 1.5}})
    station.loop.step(5)

    assert station.controller("gripper").fault is None
    assert goal.status is GoalStatus.SUCCEEDED
    assert positions(station)[0] == pytest.approx(1.5)


def test_a_set_point_that_is_overtaken_by_a_new_epoch_is_void(station, monkeypatch):
    station.switch_controllers(SwitchRequest(start=("group",)))
    station.loop.step(2)
    port = station.manager.get_controller("group").set_points
    clock = ManualClock()

    def now():
        station.loop.control_cycle.next_epoch("A reset.")
        return 0.0

    # A set-point that expires asks for the time between the checks and the slot.
    monkeypatch.setattr(clock, "now", now)
    monkeypatch.setattr(port, "clock", clock)
    station.motion.set_command("group", [0.3, 0.3], timeout=1.0)
    station.loop.step(3)

    assert positions(station) == [0.0, 0.0]
    monkeypatch.undo()
    station.motion.set_command("group", [0.3, 0.3])
    station.loop.step(3)
    assert positions(station) == [0.3, 0.3]


def test_set_points_are_let_expire_and_unknown_controllers_left_out():
    station = make_spring_station()
    station.loop.step()
    station.load_controller("spring", "test/Spring", {"joint": "j"})
    port = station.manager.get_controller("spring").set_points
    station.motion.let_go(["spring", "unknown"], "Lost.")
    assert port.take() is None  # nobody has commanded anything yet
    assert not port.has_changed()

    station.switch_controllers(SwitchRequest(start=("spring",)))
    station.motion.set_command("spring", [0.5])
    station.loop.step()
    station.motion.let_go(["spring"], "Lost.")
    station.loop.step()

    assert port.take_expiry()


def test_goals_of_who_loses_control_are_cancelled_with_the_reason(arm):
    done = arm.motion.submit_goal("arm", {"trajectory": TRAJECTORY})
    arm.loop.step(600)
    goal = arm.motion.submit_goal("arm", {"trajectory": TRAJECTORY})
    arm.loop.step(200)

    arm.motion.let_go(["arm"], "Grace has taken control from Ada by force.")
    arm.loop.step()
    held = positions(arm)
    arm.loop.step(400)

    assert goal.status is GoalStatus.PREEMPTED
    assert goal.result.message == "Grace has taken control from Ada by force."
    assert done.status is GoalStatus.SUCCEEDED
    assert positions(arm) == held


def test_a_trajectory_of_who_loses_control_ends(arm):
    arm.motion.follow_trajectory("arm", TRAJECTORY)
    arm.loop.step(200)

    arm.motion.let_go(["arm"], "Lost.")
    arm.loop.step(2)
    held = positions(arm)
    arm.loop.step(400)

    assert held != [0.4, -0.4]
    assert positions(arm) == held


@pytest.mark.parametrize("follow", ["goal", "trajectory"])
def test_control_that_is_lost_during_the_planning_ends_what_was_planned(arm, follow):
    calls = []

    def admit():
        calls.append(arm.loop.cycle)
        if len(calls) == 2:
            raise ControllerStateError("Grace holds control.", remedy="Wait.")

    motion = arm.motion
    command = {
        "goal": lambda: motion.submit_goal(
            "arm", {"trajectory": TRAJECTORY}, admit=admit
        ),
        "trajectory": lambda: motion.follow_trajectory("arm", TRAJECTORY, admit=admit),
    }[follow]
    with pytest.raises(ControllerStateError, match="Grace"):
        command()
    arm.loop.step(600)

    assert positions(arm) == [0.0, 0.0]
    assert all(goal.is_final() for goal in arm.motion.goals("arm"))


@pytest.mark.parametrize("values", ["0.5", 0.5, {"j1": 0.5}, None])
def test_a_command_that_is_no_list_is_refused(station, values):
    station.switch_controllers(SwitchRequest(start=("group",)))
    with pytest.raises(InvalidCommandError, match="must be a list") as caught:
        station.motion.set_command("group", values)
    assert f"'group' is {values!r}" in str(caught.value)
