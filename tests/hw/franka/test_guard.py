"""The guard under all kinds of command; MuJoCo and Coal judge how near arms come."""

import re

import numpy as np
import pytest

from station.compiled import status
from station.core.control.switching import SwitchRequest
from station.core.franka.franka_robot_state import RobotMode
from station.core.geometry.scene import SceneObject
from station.core.ports.goal import GoalStatus
from tests.franka_station import JOINTS, make_franka_station
from tests.hw.franka.guarded_motions import (
    ARM_MARGIN,
    KINDS,
    PERIOD,
    TOLERANCE,
    Motions,
    TwoArms,
    check,
)

compiled_alone = pytest.mark.skipif(
    not status().is_compiled,
    reason="minutes, interpreted; test_guard.py of core is not",
)

FAR = {"type": "sphere", "size": [0.1], "position": [2, 0, 0], "role": "keep_out"}


@pytest.fixture(scope="module")
def motions() -> Motions:
    return Motions()


@compiled_alone
@pytest.mark.parametrize("kind", KINDS)
def test_no_motion_comes_nearer_than_its_margin(motions, kind):
    near, free = check(motions, [kind], range(4), every=100)
    assert near + free >= 2


@pytest.mark.long
@compiled_alone
@pytest.mark.parametrize("kind", KINDS)
def test_more_motions_keep_their_margin_by_two_judges(motions, kind):
    check(motions, [kind], range(4, 20), every=10)


@compiled_alone
@pytest.mark.parametrize("kind", ["pose", "twist"])
def test_a_cartesian_motion_ends_where_a_wall_appears(motions, kind):
    motions.begin(kind, 1, guarded=False)
    pose, y = np.array(motions.hw.robot_state.O_T_EE), 0.0
    for cycle in range(900):
        speed = 0.5 * min(cycle / 400, 1.0)
        y += speed * PERIOD
        values = [0.0, speed, *[0.0] * 4]
        if kind == "pose":
            values = pose + y * np.eye(16)[13]
        if cycle == 500:
            x, begin, z = pose[12:15]
            place = (x, begin + y + 0.16, z)
            wall = SceneObject("wall", "box", (0.4, 0.02, 0.6), place, role="keep_out")
            motions.hw.guards()[0].prepare([wall], None)()
        motions.handles[0].set_command([*values])
        motions.hw.write(0.0, PERIOD)
        motions.hw.read(0.0, PERIOD)
        assert (motions.hw.robot_state.robot_mode is RobotMode.MOVE) == (cycle < 500)
    reason = motions.hw._sender.refusal
    assert re.fullmatch(r"guard_reflex: \w+ would have .* 20 mm to 'wall'", reason)
    assert np.abs(motions.hw.robot_state.dq).max() < 1e-2


@compiled_alone
@pytest.mark.parametrize("seed", [1, 4])
def test_two_arms_that_swing_at_each_other_keep_their_margin(seed):
    arms = TwoArms()
    assert arms.swing(seed, guarded=False) < ARM_MARGIN
    assert arms.swing(seed, guarded=True) >= ARM_MARGIN - TOLERANCE


def follow_path(station, cycles, **tolerances):
    """Return a goal that turned joint 1 by a quarter of a turn within a second."""
    kind = "position_controllers/JointTrajectoryController"
    station.load_controller("path", kind, {"joints": JOINTS})
    station.switch_controllers(SwitchRequest(start=("path",)))
    station.loop.step(2)
    there = [1.57, *station.latest().position[1:7]]
    points = [{"positions": there, "time_from_start": 1.0}]
    trajectory = {"joint_names": JOINTS, "points": points}
    goal = station.motion.submit_goal("path", {"trajectory": trajectory, **tolerances})
    station.loop.step(cycles)
    return goal


def test_the_message_of_a_goal_says_that_the_guard_was_in_its_way():
    ball = {**FAR, "name": "ball", "position": [0.22, 0.36, 0.6]}
    station = make_franka_station(objects=[ball])
    within = [{"name": JOINTS[0], "position": 0.02}]
    goal = follow_path(station, 3500, goal_tolerance=within, goal_time_tolerance=2)

    assert goal.status is GoalStatus.ABORTED
    nearest = station.surroundings.clearance("panda")
    assert nearest.is_slowing
    said = f"'{nearest.link}' is 2[0-5] mm from 'ball' and has to stay 20 mm away."
    assert re.search(f"The guard holds 'panda' back: {said}$", goal.result.message)


def test_a_guard_that_let_everything_pass_is_not_blamed():
    station = make_franka_station(objects=[{**FAR, "name": "ball"}])
    within = [{"name": JOINTS[0], "position": 1e-9}]
    goal = follow_path(station, 500, path_tolerance=within)

    assert goal.status is GoalStatus.ABORTED
    assert "guard" not in goal.result.message
