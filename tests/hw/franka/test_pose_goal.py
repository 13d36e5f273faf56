"""A sequence of poses goes on when one is late."""

import pytest

from station.core.rigid_motion import displace
from station.hw.franka.arm_limits import PANDA_LIMITS
from station.hw.franka.franka_kinematics import IDENTITY
from station.hw.franka.pose_goal import PoseGoal


@pytest.fixture
def goal():
    goal = PoseGoal(PANDA_LIMITS.translation, PANDA_LIMITS.rotation)
    goal.begin(IDENTITY)
    return goal


def along(time):
    """Return a pose on a way of constant acceleration, 1 m/s^2 and 2 rad/s^2."""
    return displace(IDENTITY, (0.5 * time * time, 0.0, 0.0), (0.0, 0.0, time * time))


@pytest.mark.parametrize("late", [1, 3, 15])
def test_constant_acceleration_is_continued(goal, late):
    for cycle in range(1, 101):
        goal.note(along(cycle * 1e-3), 1e-3)
    for _ in range(late):
        pose = goal.go_on(1e-3)

    assert pose == pytest.approx(along(0.1 + late * 1e-3), abs=1e-6)


def test_a_late_pose_counts_with_its_own_period(goal):
    for cycle in range(0, 101, 4):
        goal.note(along(cycle * 1e-3), 4e-3 if cycle else 0.0)
    pose = goal.go_on(1e-3)

    assert pose == pytest.approx(along(0.101), abs=5e-6)


def test_a_goal_at_rest_stays(goal):
    goal.note(IDENTITY, 1e-3)

    assert goal.go_on(1e-3) == pytest.approx(IDENTITY)


def test_jumps_are_not_continued(goal):
    target = displace(IDENTITY, (0.001, 0.0, 0.0), (0.0, 0.0, 0.0))
    goal.note(target, 1e-3)

    assert goal.go_on(1e-3) == target
