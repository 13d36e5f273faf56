"""Pause, step, reset: controllers survive, and nothing old moves anything."""

import pytest

from station.core.clock import ManualClock
from station.core.control.controller import ControllerState
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    ParameterError,
    SimulationError,
    StaleEpochError,
)
from station.core.facade.simulation_control import MOST_STEPS, SimulationControl
from station.core.franka.gripper_services import Grippers
from station.core.hardware.interfaces import JointStateInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.loop.control_loop import ControlLoop
from station.core.loop.stop_latch import StopState
from station.core.parameters import Parameters
from station.core.ports.goal import GoalStatus
from tests.franka_station import make_franka_station
from tests.patient_clock import PatientClock
from tests.two_joint_station import TRAJECTORY, make_station

pytestmark = pytest.mark.alone


@pytest.fixture
def station():
    """Return a station whose thread runs on a clock that never waits."""
    station = make_station(clock=PatientClock())
    station.loop.start()
    for _ in range(2):  # the first cycle is recorded when the second takes a call
        station.loop.run_in_cycle(lambda: None)
    yield station
    station.loop.stop()


def _pause(station):
    return station.simulation.change(paused=True)


def _let_the_wall_clock_run(station, duration=1.0):
    clock = station.loop.clock
    end = clock.now() + duration
    while clock.now() < end:
        station.loop.run_in_cycle(lambda: None)


def test_time_stands_still_while_paused_and_goes_on_without_a_leap(station):
    _pause(station)
    time = station.loop.time

    _let_the_wall_clock_run(station)
    assert station.loop.time == time
    assert station.ready() is None

    station.simulation.change(paused=False)
    skipped = station.loop.report().skipped
    _let_the_wall_clock_run(station, 0.01)
    assert station.loop.time > time
    assert station.loop.report().skipped == skipped


def test_a_step_is_exactly_so_many_cycles(station):
    _pause(station)
    time = station.loop.time

    report = station.simulation.step(25)

    assert station.loop.time == pytest.approx(time + 0.025)
    assert (report.paused, report.steps_due) == (True, 0)


def test_switches_work_while_paused_and_the_controller_waits_for_time(station):
    _pause(station)

    result = station.switch_controllers(SwitchRequest(["group"]))

    assert result.started == ("group",)
    assert station.controller("group").state is ControllerState.RUNNING
    assert station.controller_sample("group") is None
    station.simulation.step()
    assert station.controller_sample("group") is not None


def test_a_stop_works_while_paused(station):
    station.switch_controllers(SwitchRequest(["group"]))
    _pause(station)
    epoch = station.epoch

    station.stop("smoke")
    _let_the_wall_clock_run(station, 0.01)

    assert station.controller("group").state is ControllerState.STOPPED
    assert station.epoch == epoch + 1
    assert station.loop.stop_latch.state is StopState.STOPPED


def test_a_set_point_times_out_on_the_wall_clock_while_paused(station):
    station.switch_controllers(SwitchRequest(["group"]))
    _pause(station)
    station.motion.set_command("group", [1.0, 1.0], timeout=0.05)

    _let_the_wall_clock_run(station, 0.1)
    station.simulation.step(10)

    assert station.latest().position == [0.0, 0.0]


def test_the_loop_without_its_thread_steps_too():
    station = make_station()
    _pause(station)

    station.simulation.step(3)

    assert station.loop.cycle == 3


def test_the_pace_can_be_changed(station):
    report = station.simulation.change(real_time_factor=0.5)

    assert report.real_time_factor == 0.5
    assert station.loop.report().rate == pytest.approx(500.0)


@pytest.mark.parametrize(
    "factor", [0.0, -1.0, 1e-308, 1e-6, 0.009, 101.0, float("nan"), float("inf")]
)
def test_an_impossible_pace_is_refused_and_nothing_changes(station, factor):
    with pytest.raises(ParameterError, match=r"0\.01 to 100"):
        station.simulation.change(paused=True, real_time_factor=factor)

    assert not station.simulation.report().paused


@pytest.mark.parametrize("cycles", [0, -1, MOST_STEPS + 1])
def test_an_impossible_number_of_steps_is_refused(station, cycles):
    _pause(station)

    with pytest.raises(ParameterError, match="allowed are 1 to 10000"):
        station.simulation.step(cycles)


def test_only_what_is_paused_can_be_stepped(station):
    with pytest.raises(SimulationError, match="not paused"):
        station.simulation.step()


def test_a_reset_puts_the_joints_where_asked_and_voids_what_was_commanded(station):
    station.switch_controllers(SwitchRequest(["group"]))
    epoch = station.epoch
    station.motion.set_command("group", [1.0, 1.0])
    station.loop.run_in_cycle(lambda: None)

    station.simulation.reset({"j2": -0.5})
    _let_the_wall_clock_run(station, 0.1)

    assert station.latest().position == [0.0, -0.5]
    assert station.controller("group").state is ControllerState.RUNNING
    with pytest.raises(StaleEpochError):
        station.motion.set_command("group", [1.0, 1.0], epoch=epoch)


def test_station_time_goes_on_through_a_reset_and_the_worlds_begins_anew(station):
    _let_the_wall_clock_run(station, 0.05)
    _pause(station)
    time = station.loop.time
    assert station.simulation.report().time > 0.0

    report = station.simulation.reset()

    assert report.time == 0.0
    assert station.loop.time == time


def test_a_goal_ends_with_a_reset(station):
    station.switch_controllers(SwitchRequest(["arm"]))
    # Time stands still, or the goal might end before this thread gets to the reset.
    _pause(station)
    goal = station.motion.submit_goal("arm", {"trajectory": TRAJECTORY})

    station.simulation.reset()
    station.simulation.change(paused=False)
    _let_the_wall_clock_run(station, 1.0)

    assert goal.status is GoalStatus.PREEMPTED
    assert "reset" in goal.result.message
    assert station.latest().position == [0.0, 0.0]


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        ({"j3": 0.0}, "no joint 'j3'"),
        ({"j1": 0.2, "j2": float("nan")}, "'j2' cannot be put to nan"),
    ],
)
def test_an_impossible_reset_is_refused_and_nothing_changes(
    station, positions, message
):
    epoch = station.epoch

    with pytest.raises(ParameterError, match=message):
        station.simulation.reset(positions)

    assert station.epoch == epoch
    assert station.latest().position == [0.0, 0.0]


def test_a_franka_arm_is_reset_within_its_limits_only():
    station = make_franka_station()
    with pytest.raises(ParameterError, match=r"allowed are -2.8973 to 2.8973"):
        station.simulation.reset({"panda_joint1": 3.0})

    station.switch_controllers(SwitchRequest(["arm"]))
    station.loop.step(20)
    station.simulation.reset({"panda_joint1": 0.5})
    station.loop.step(200)

    assert station.latest().position[0] == pytest.approx(0.5, abs=1e-3)
    assert station.controller("arm").state is ControllerState.RUNNING


class RealRobot(RobotHW):
    """A robot in no simulation."""

    def __init__(self):
        super().__init__()
        self.register_interface(JointStateInterface())


@pytest.mark.parametrize(
    "ask",
    [
        lambda simulation: simulation.report(),
        lambda simulation: simulation.change(paused=True),
        lambda simulation: simulation.step(),
        lambda simulation: simulation.reset(),
    ],
)
def test_a_real_robot_can_do_none_of_it(ask):
    hw, clock = RealRobot(), ManualClock()
    loop = ControlLoop(hw, ControllerManager(hw, Parameters(), [], clock), clock=clock)

    with pytest.raises(SimulationError, match="RealRobot is not simulated"):
        ask(SimulationControl(loop))


def test_a_reset_goes_to_a_keyframe_and_positions_come_before_it():
    station = make_franka_station()
    assert set(station.simulation.report().keyframes) == {"ready", "default"}

    station.simulation.reset({"panda_joint1": 0.3}, "default")
    station.loop.step()

    position = dict(zip(station.joint_names, station.latest().position, strict=True))
    assert position["panda_joint1"] == pytest.approx(0.3, abs=1e-3)
    assert position["panda_joint4"] == pytest.approx(-2.35619, abs=1e-3)
    assert Grippers(station.robots).state("panda").width == pytest.approx(
        0.002, abs=2e-3
    )


def test_an_unknown_keyframe_is_refused_and_nothing_changes():
    station = make_franka_station()
    epoch = station.epoch

    with pytest.raises(ParameterError, match="no keyframe 'redy'") as caught:
        station.simulation.reset(keyframe="redy")
    assert "Did you mean 'ready'?" in caught.value.remedy
    assert station.epoch == epoch
