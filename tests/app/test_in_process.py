"""A station inside a program: stepped in virtual time, or with its thread."""

import math

import numpy as np
import pytest

import station
from station.client import MotionError
from station.core.control.controller import ControllerState
from station.core.errors import (
    InvalidCommandError,
    InvalidTrajectoryError,
    LoopError,
    RobotDescriptionError,
)
from station.core.loop.stop_latch import StopState
from station.reports import RehearsalOutcome

GROUP = "effort_group_position_controller"
MOCK = {
    "station": {"rate": 100},
    "robot": {"type": "mock_hw/MockRobotHW", "joints": ["a", "b"]},
    "controllers": {
        "group": {
            "type": "position_controllers/JointGroupPositionController",
            "joints": ["a", "b"],
        },
        "arm": {
            "type": "position_controllers/JointTrajectoryController",
            "joints": ["a", "b"],
        },
    },
    "start": ["group"],
}


@pytest.fixture
def mock():
    """Return a stepped station with two joints at 100 Hz."""
    with station.open(MOCK) as opened:
        yield opened


def test_time_passes_when_cycles_are_run(mock):
    before = mock.time

    mock.step(5)
    mock.run(0.2)

    assert mock.time - before == pytest.approx(0.25)
    assert not mock.is_threaded


def test_controllers_of_the_configuration_run_and_take_set_points(mock):
    mock.command("group", [0.5, -0.5])
    mock.step(2)

    assert mock.positions() == {"a": 0.5, "b": -0.5}


def test_move_takes_the_joints_over():
    with station.open(settings={"start": [GROUP]}) as panda:
        panda.move_to({"panda_joint1": 0.25}, duration=1.0)

        assert panda.positions()["panda_joint1"] == pytest.approx(0.25, abs=1e-3)
        assert panda.facade.controller(GROUP).state is ControllerState.STOPPED
        with pytest.raises(MotionError, match="3 positions were given for 7 joints"):
            panda.move_to([0.1, 0.1, 0.1])
        with pytest.raises(InvalidTrajectoryError, match="its limit is"):
            panda.move_to({"panda_joint1": 0.0}, duration=0.01)


def test_controllers_that_cannot_be_loaded_are_told(mock):
    assert list(mock.not_loaded) == ["arm"]

    with pytest.raises(MotionError, match="'robot_description' is missing"):
        mock.move_to([0.1, 0.1])


def test_every_cycle_is_collected_however_many(mock):
    mock.command("group", [0.5, -0.5])

    samples = mock.collect(50.0)

    assert samples["position"].shape == (5000, 2)
    assert samples.lost == 0
    np.testing.assert_allclose(np.diff(samples.stamp), 0.01)
    assert mock.collect(0.1, "group")["actual"][-1] == pytest.approx([0.5, -0.5])


@pytest.mark.parametrize("seconds", [-1.0, math.nan, math.inf, "1", True])
def test_an_impossible_time_cannot_pass(mock, seconds):
    before = mock.time

    for wait in (mock.run, mock.collect):
        with pytest.raises(InvalidCommandError, match="cannot pass"):
            wait(seconds)

    assert mock.time == before


def test_a_reset_is_seen_at_once():
    with station.open() as arm:
        arm.move_to("stretched", duration=2.0)
        arm.reset()

        assert arm.positions()["panda_joint4"] == pytest.approx(-2.356, abs=1e-3)


def test_single_values_can_be_set():
    with station.open(MOCK, settings={"station.rate": 500}) as opened:
        assert opened.facade.loop.period == 0.002


def test_steps_of_a_rehearsal_are_those_of_the_api():
    with station.open() as panda:
        told = panda.rehearse([{"kind": "switch", "start": [GROUP]}], 0.05)
        told_of_a_tuple = panda.rehearse(({"kind": "switch", "start": (GROUP,)},), 0.05)

    assert (told.outcome, told.error) == (RehearsalOutcome.COMPLETED, None)
    assert told_of_a_tuple.digest == told.digest


@pytest.mark.parametrize(
    ("steps", "seconds", "reason"),
    [
        ([{"kind": "dance"}], None, "steps/0: has the kind 'dance'; allowed are"),
        ([{"kind": "switch", "begin": ["arm"]}], None, "begin: is no field"),
        ([{"kind": "goal", "name": "arm"}], None, "request: is missing"),
        ([], math.nan, "seconds: must be a finite number"),
        ([], math.inf, "seconds: must be a finite number"),
        ([], 0.0, r"seconds: must be greater than 0\.0"),
        ([], 1e9, r"seconds: must be at most 60\.0"),
    ],
)
def test_what_cannot_be_rehearsed_is_refused(mock, steps, seconds, reason):
    with pytest.raises(InvalidCommandError, match=reason):
        mock.rehearse(steps, seconds)


def test_closing_stops_the_robot():
    opened = station.open(MOCK)
    opened.close()

    assert opened.facade.loop.stop_latch.state is StopState.STOPPED


def test_impossible_robot_is_refused():
    robot = {"type": "mujoco_hw/MujocoRobotHW", "robot_description": "/no/such.urdf"}

    with pytest.raises(RobotDescriptionError, match="cannot be read"):
        station.open({"robot": robot})


def test_validity_of_a_set_point_is_virtual_time():
    with station.open() as opened:
        opened.switch(start=["position_jog_controller"])
        opened.command("position_jog_controller", [0.1] + [0.0] * 6, timeout=0.3)
        opened.run(2.0)

        assert opened.latest().velocity[0] == pytest.approx(0.0, abs=0.02)  # noise
        assert 0.02 < opened.positions()["panda_joint1"] < 0.06


@pytest.mark.slow
def test_every_run_is_the_same_bit_for_bit():
    def run():
        with station.open() as opened:
            opened.move_to({"panda_joint1": 0.2})
            opened.switch(start=[GROUP], stop=["position_joint_trajectory_controller"])
            opened.set_gains(GROUP, {"panda_joint1/p": 300.0})
            opened.command(GROUP, [0.3, -0.785, 0, -2.356, 0, 1.571, 0.785])
            return opened.collect(0.5)["position"]

    np.testing.assert_array_equal(run(), run())


@pytest.mark.slow
@pytest.mark.alone
def test_control_thread_runs_on_the_wall_clock():
    with station.open(MOCK, threaded=True) as opened:
        opened.command("group", [0.5, -0.5])
        opened.run(0.1)

        assert opened.positions() == {"a": 0.5, "b": -0.5}
        with pytest.raises(LoopError, match="Cannot step"):
            opened.step()
    assert opened.facade.ready() == "The control loop is not running."
