"""A sequence of poses goes on when one is late."""

from itertools import pairwise

import pytest

from station.core.rigid_motion import displace, twist_between
from station.hw.franka.arm_limits import PANDA_LIMITS
from station.hw.franka.franka_kinematics import IDENTITY
from station.hw.franka.pose_goal import PoseGoal

CYCLE = 1e-3


@pytest.fixture
def goal():
    goal = PoseGoal(PANDA_LIMITS.translation, PANDA_LIMITS.rotation, CYCLE)
    goal.begin(IDENTITY)
    return goal


def along(time):
    """Return a pose on a way of constant acceleration, 1 m/s^2 and 2 rad/s^2."""
    return displace(IDENTITY, (0.5 * time * time, 0.0, 0.0), (0.0, 0.0, time * time))


@pytest.mark.parametrize("late", [1, 3, 15])
def test_constant_acceleration_is_continued(goal, late):
    for cycle in range(1, 101):
        goal.note(along(cycle * CYCLE), CYCLE)
    for _ in range(late):
        pose = goal.go_on()

    assert pose == pytest.approx(along(0.1 + late * CYCLE), abs=2e-5)


def test_punctual_poses_are_passed_on_as_they_are(goal):
    for cycle in range(1, 101):
        assert goal.note(along(cycle * CYCLE), CYCLE) == along(cycle * CYCLE)


@pytest.mark.parametrize("lost", [0, 6])
def test_a_gap_is_closed_without_a_step(goal, lost):
    """Also when the goal has not gone on for all of the time."""
    track, time = [], 0.0
    for late in [0] * 50 + [0, 14, 0, 3, 0, 1, 2] + [0] * 1_000:
        track += [goal.go_on() for _ in range(late)]
        period = (late + 1 + (lost if late else 0)) * CYCLE
        time += period
        target = along(time)
        track.append(goal.note(target, period))
    twists = [twist_between(a, b, CYCLE) for a, b in pairwise(track)]
    steps = [
        max(abs(y - x) for x, y in zip(a[:3], b[:3], strict=True))
        for a, b in pairwise(twists)
    ]

    # A fading gap takes rate^2 times its size: 0.2 m/s^2 for 2 mm, besides 1 m/s^2.
    assert max(steps[60:]) / CYCLE < 2.0
    assert track[-1] == pytest.approx(target, abs=1e-4)


@pytest.mark.parametrize("slow", [2, 4])
def test_a_slow_loop_is_followed_without_a_lag(goal, slow):
    for cycle in range(slow, 1_200, slow):
        for _ in range(slow - 1):
            goal.go_on()
        pose = goal.note(along(cycle * CYCLE), slow * CYCLE)

    # What the abrupt start has left, fades slowly in a slow loop.
    assert pose == pytest.approx(along(cycle * CYCLE), abs=3e-4)


def test_a_goal_at_rest_stays(goal):
    goal.note(IDENTITY, CYCLE)

    assert goal.go_on() == pytest.approx(IDENTITY)


def test_jumps_are_passed_on_and_not_continued(goal):
    target = displace(IDENTITY, (0.001, 0.0, 0.0), (0.0, 0.0, 0.0))
    goal.go_on()

    assert goal.note(target, 2 * CYCLE) == target
    assert goal.go_on() == target
