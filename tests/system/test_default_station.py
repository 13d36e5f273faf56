"""What `station run` runs without a file does what a first user tries."""

from operator import truediv

import pytest

from station.app.composition import compose
from station.config import load_config
from station.core.clock import ManualClock
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.hw.franka.franka_hw import FrankaHW
from station.hw.mujoco.stops_and_brakes import BRAKES

NAME = "effort_group_position_controller"
STEPS = [
    [sign * 0.3 if joint == stepped else 0.0 for joint in range(7)]
    for stepped in range(7)
    for sign in (1.0, -1.0)
] + [[0.3, -0.3, 0.3, 0.3, -0.3, 0.3, -0.3], [-0.3, 0.3, -0.3, -0.3, 0.3, -0.3, 0.3]]


@pytest.fixture
def station() -> Station:
    """The default station, stepped by hand, its effort controller running."""
    station = compose(load_config(None), ManualClock()).station
    station.loop.step(20)
    station.switch_controllers(SwitchRequest(start=(NAME,)))
    return station


def franka(station: Station) -> FrankaHW:
    """Return the robot of the station."""
    hw = station.loop.hw
    assert isinstance(hw, FrankaHW)
    return hw


@pytest.mark.parametrize("step", STEPS)
def test_a_pose_0_3_rad_away_is_reached_within_two_seconds(station, step):
    positions = station.latest().position[:7]
    goal = [q + dq for q, dq in zip(positions, step, strict=True)]
    station.motion.set_command(NAME, goal)
    station.loop.step(2000)
    assert station.controller(NAME).fault is None
    assert station.latest().position[:7] == pytest.approx(goal, abs=0.02)


def test_gains_that_make_the_arm_swing_do_not_end_the_motion(station):
    station.tuning.set_gains(NAME, {"panda_joint1/p": 500.0, "panda_joint1/d": 10.0})
    station.motion.set_command(NAME, [0.1, *station.latest().position[1:7]])
    swing = []
    for _ in range(400):
        station.loop.step()
        swing.append(station.latest().position[0])
    assert max(swing) > 0.12
    assert station.controller(NAME).fault is None


@pytest.mark.long
@pytest.mark.parametrize("step", [*STEPS[8:12], *STEPS[14:]])
def test_a_step_that_throws_a_joint_at_its_velocity_limit_ends_as_on_a_franka(
    station, step
):
    gains = station.tuning.gains("effort_joint_trajectory_controller").values
    p_and_d = {k: v for k, v in gains.items() if k[-2:] in {"/p", "/d"}}
    station.tuning.set_gains(NAME, p_and_d)
    positions = station.latest().position[:7]
    goal = [q + dq for q, dq in zip(positions, step, strict=True)]
    station.motion.set_command(NAME, goal)
    station.loop.step(1000)
    errors = franka(station).arm.errors()
    assert {error.name for error in errors} == {"joint_velocity_violation"}
    assert station.controller(NAME).state != "running"
    brakes = [c for c in franka(station).clamps() if c.hardware_interface == BRAKES]
    assert brakes[0].last.joint in {f"panda_{error.where}" for error in errors}
    station.robots.recover_all()
    assert franka(station).mode() == "idle"


@pytest.mark.long
@pytest.mark.parametrize("step", STEPS)
def test_the_joints_stay_below_their_velocity_limits_in_those_steps(station, step):
    positions = station.latest().position[:7]
    goal = [q + dq for q, dq in zip(positions, step, strict=True)]
    limits = franka(station).arm.limits.velocity
    station.motion.set_command(NAME, goal)
    fastest = 0.0
    for _ in range(1000):
        station.loop.step()
        speeds = map(abs, station.latest().velocity)
        fastest = max(fastest, *map(truediv, speeds, limits))
    assert 0.1 < fastest < 0.97
