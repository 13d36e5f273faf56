"""When a goal is aborted, when it succeeds, and what it says."""

import pytest

from station.controllers.joint_trajectory_controller.execution import (
    GoalSupervision,
    JointTracking,
)
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.hardware.interfaces import JointStateGroup, JointStateHandle
from station.core.ports.goal import Goal, GoalStatus
from station.core.trajectory import (
    JointTolerances,
    JointTrajectorySegment,
    PosVelAccState,
    QuinticSplineSegment,
    StateTolerances,
)
from station.memory.doubles import put, zeros

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
def tracking():
    columns = zeros(2), zeros(2), zeros(2)
    handles = [JointStateHandle(j.name, *columns, k) for k, j in enumerate(JOINTS)]
    return JointTracking(JOINTS, JointStateGroup(handles))


@pytest.fixture
def supervision(goal, trajectory, tracking):
    supervision = GoalSupervision(JOINTS, tracking)
    supervision.begin_goal(goal, 0.0, trajectory)
    return supervision


@pytest.fixture
def check(supervision, trajectory, tracking):
    """Return a way to check the goal at a time and with errors."""
    active = [segments[0] for segments in trajectory]

    def check_goal(now, positions=(0.0, 0.0), velocities=(0.0, 0.0)):
        put(tracking.errors, positions)
        put(tracking.rate_errors, velocities)
        return supervision.check_goal(active, trajectory, now)

    return check_goal


def test_within_the_bounds_the_goal_goes_on(check, goal):
    assert not check(0.5, (0.1, -0.1), (1.0, -1.0))
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
    check, supervision, goal, positions, velocities, message
):
    assert check(0.5, positions, velocities)
    assert goal.status is GoalStatus.ABORTED
    assert message in goal.result.message
    assert "after 0.500 s" in goal.result.message
    assert supervision.goal is None


def test_arriving_needs_all_joints(check, goal):
    assert not check(2.0, (0.0, 0.05))
    assert goal.status is GoalStatus.ACTIVE
    assert not check(2.1, (0.0, 0.005))
    assert goal.status is GoalStatus.SUCCEEDED


def test_not_arriving_aborts_after_the_goal_time(check, goal):
    assert not check(2.49, (0.0, 0.05))
    assert check(2.5, (0.0, 0.05))
    assert goal.result.code == -5
    assert goal.result.details["joint"] == "slide"


def test_a_new_goal_preempts_the_old_one(check, supervision, trajectory, goal):
    supervision.begin_goal(None, 1.0, trajectory)
    assert goal.status is GoalStatus.PREEMPTED
    assert not check(1.5, (9.0, 9.0))


def test_segments_of_an_older_goal_are_not_supervised(check, supervision, trajectory):
    newer = Goal("2", {})
    supervision.begin_goal(newer, 1.0, trajectory)
    assert not check(1.5, (9.0, 9.0))
    assert newer.status is GoalStatus.ACTIVE
