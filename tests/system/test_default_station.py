"""What `station run` runs without a file does what a first user tries."""

import pytest

from station.app.composition import compose
from station.config import load_config
from station.core.clock import ManualClock
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station

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


@pytest.mark.parametrize("step", STEPS)
def test_a_pose_0_3_rad_away_is_reached_within_two_seconds(station, step):
    positions = station.latest().position[:7]
    goal = [q + dq for q, dq in zip(positions, step, strict=True)]
    station.motion.set_command(NAME, goal)
    station.loop.step(2000)
    assert station.controller(NAME).fault is None
    assert station.latest().position[:7] == pytest.approx(goal, abs=0.02)


def test_gains_that_make_the_arm_swing_do_not_end_the_motion(station):
    station.set_gains(NAME, {"panda_joint1/p": 1500.0, "panda_joint1/d": 10.0})
    station.motion.set_command(NAME, [0.3, *station.latest().position[1:7]])
    swing = []
    for _ in range(400):
        station.loop.step()
        swing.append(station.latest().position[0])
    assert max(swing) > 0.34
    assert station.controller(NAME).fault is None
