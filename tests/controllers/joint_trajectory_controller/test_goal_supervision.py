"""When a goal is aborted, when it succeeds, and what it says."""

import pytest

from station.controllers.joint_trajectory_controller.goal_supervision import (
    GoalSupervision,
    StateErrors,
)
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.ports.goal import Goal, GoalStatus
from station.core.trajectory import (
    JointTolerances,
    JointTrajectorySegment,
    PosVelAccState,
    QuinticSplineSegment,
    StateTolerances,
)

JOINTS = [
    JointDescription("elbow", JointType.REVOLUTE),
    JointDescription("slide", JointType.PRISMATIC),
]
BOUNDS = JointTolerances(StateTolerances(0.1, 1.0), StateTolerances(0.01, 0.2), 0.5)


@pytest.fixture
def goal():
    return Goal("1", {})


@pytest.fixture
def trajectory(goal):
    end = PosVelAccState([1.0])
    spline = QuinticSplineSegment(0.0, PosVelAccState([0.0]), 2.0, end)
    return [
        [JointTrajectorySegment(spline, end, goal=goal, tolerances=BOUNDS)]
        for _ in JOINTS
    ]


@pytest.fixture
def supervision(goal, trajectory):
    supervision = GoalSupervision(JOINTS)
    supervision.begin(goal, 0.0, trajectory)
    return supervision


def _check(supervision, trajectory, now, positions=(0.0, 0.0), velocities=(0.0, 0.0)):
    active = [segments[0] for segments in trajectory]
    errors = StateErrors(list(positions), list(velocities))
    return supervision.check(active, trajectory, errors, now)


def test_within_the_bounds_the_goal_goes_on(supervision, trajectory, goal):
    assert not _check(supervision, trajectory, 0.5, (0.1, -0.1), (1.0, -1.0))
    assert goal.status is GoalStatus.ACTIVE
    assert goal.progress == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("positions", "velocities", "message"),
    [
        ((-0.12, 0.0), (0.0, 0.0), "'elbow' has a position error of -0.12 rad on its"),
        ((0.0, 0.2), (0.0, 0.0), "'slide' has a position error of 0.2 m on its path"),
        ((0.0, 0.0), (0.0, 1.5), "'slide' has a velocity error of 1.5 m/s on its"),
    ],
)
def test_leaving_the_path_aborts(
    supervision, trajectory, goal, positions, velocities, message
):
    assert _check(supervision, trajectory, 0.5, positions, velocities)
    assert goal.status is GoalStatus.ABORTED
    assert message in goal.result.message
    assert "after 0.500 s" in goal.result.message
    assert supervision.goal is None


def test_arriving_needs_all_joints(supervision, trajectory, goal):
    assert not _check(supervision, trajectory, 2.0, (0.0, 0.05))
    assert goal.status is GoalStatus.ACTIVE
    assert not _check(supervision, trajectory, 2.1, (0.0, 0.005))
    assert goal.status is GoalStatus.SUCCEEDED


def test_not_arriving_aborts_after_the_goal_time(supervision, trajectory, goal):
    assert not _check(supervision, trajectory, 2.49, (0.0, 0.05))
    assert _check(supervision, trajectory, 2.5, (0.0, 0.05))
    assert goal.result.code == -5
    assert goal.result.details["joint"] == "slide"


def test_a_new_goal_preempts_the_old_one(supervision, trajectory, goal):
    supervision.begin(None, 1.0, trajectory)
    assert goal.status is GoalStatus.PREEMPTED
    assert not _check(supervision, trajectory, 1.5, (9.0, 9.0))


def test_segments_of_an_older_goal_are_not_supervised(supervision, trajectory):
    newer = Goal("2", {})
    supervision.begin(newer, 1.0, trajectory)
    assert not _check(supervision, trajectory, 1.5, (9.0, 9.0))
    assert newer.status is GoalStatus.ACTIVE
