"""Taking a trajectory over late: the bridge begins where the joints shall be then."""

import weakref

import pytest

from station.controllers.joint_trajectory_controller.execution import (
    JointTracking,
    TrajectoryExecution,
)
from station.controllers.joint_trajectory_controller.planning import TrajectoryPlanner
from station.core.description.robot_description import JointDescription
from station.core.hardware.interfaces import JointStateGroup, JointStateHandle
from station.core.trajectory import JointTrajectory, JointTrajectoryPoint
from station.memory.doubles import zeros


def _to(position, duration):
    point = JointTrajectoryPoint([position], time_from_start=duration)
    return JointTrajectory(["a"], [point])


def _cycle(execution, time, period):
    """Run a cycle of joints that are where they shall be."""
    tracking = execution.tracking
    tracking.memory.positions[:] = tracking.positions
    tracking.memory.velocities[:] = tracking.velocities
    execution.advance(time, period)


def _advance(execution, cycles, start):
    """Run ideal cycles of 1 ms; return the time after them."""
    time = start
    for _ in range(cycles):
        time += 0.001
        _cycle(execution, time, 0.001)
    return time


@pytest.fixture
def execution():
    joints = [JointDescription("a")]
    group = JointStateGroup([JointStateHandle("a", zeros(1), zeros(1), zeros(1))])
    execution = TrajectoryExecution(joints, JointTracking(joints, group))
    execution.start(50.0)
    return execution


@pytest.fixture
def planner(execution):
    return TrajectoryPlanner(execution, [JointDescription("a")])


def test_a_trajectory_that_was_planned_some_cycles_ago_is_joined_without_a_jump(
    execution, planner
):
    time = _advance(execution, 1, 50.0)
    planner.plan(_to(1.0, 1.0))
    time = _advance(execution, 500, time)
    planner.plan(_to(0.0, 1.0))
    late = execution.requests.pop()
    time = _advance(execution, 20, time)
    before = execution.tracking.positions[0]
    execution.requests.append(late)
    _advance(execution, 1, time)
    # One cycle at 1 rad/s; without a new bridge it would be 20 times that.
    assert abs(execution.tracking.positions[0] - before) < 0.0011
    _advance(execution, 1000, time)
    assert execution.tracking.positions[0] == pytest.approx(0.0, abs=1e-9)


def test_planning_starts_from_what_waits_to_be_taken_up(execution, planner):
    time = _advance(execution, 1, 50.0)
    planner.plan(_to(1.0, 1.0))
    point = JointTrajectoryPoint([0.0], time_from_start=1.0)
    planner.plan(JointTrajectory(["a"], [point], stamp=time + 0.5))
    _advance(execution, 490, time)
    assert execution.tracking.positions[0] == pytest.approx(0.49, abs=2e-3)


def test_time_that_stands_still_moves_nothing(execution, planner):
    time = _advance(execution, 1, 50.0)
    planner.plan(_to(1.0, 1.0))
    for _ in range(10):
        _cycle(execution, time, 0.0)
    assert execution.tracking.positions[0] == 0.0


def test_an_hour_of_cycles_does_not_drift(execution):
    for _ in range(3600):
        execution.advance(50.0, 1.0 / 3.0)
    assert execution.moment[2] == pytest.approx(1200e9, abs=3600)


def test_a_stop_that_waits_is_not_undone_by_a_later_start(execution, planner):
    time = _advance(execution, 1, 50.0)
    planner.plan(_to(1.0, 1.0))
    time = _advance(execution, 500, time)
    here = execution.tracking.positions[0]
    execution.hold()
    point = JointTrajectoryPoint([0.0], time_from_start=1.0)
    planner.plan(JointTrajectory(["a"], [point], stamp=time + 0.3))
    time = _advance(execution, 290, time)
    assert execution.tracking.positions[0] == pytest.approx(here, abs=2e-3)
    _advance(execution, 1100, time)
    assert execution.tracking.positions[0] == pytest.approx(0.0, abs=1e-9)


def test_what_was_executed_is_freed_by_who_plans_and_not_in_a_cycle(execution, planner):
    time = _advance(execution, 1, 50.0)
    points = [JointTrajectoryPoint([x], time_from_start=x) for x in (1.0, 2.0)]
    planner.plan(JointTrajectory(["a"], points))
    time = _advance(execution, 1, time)
    first = weakref.ref(execution.trajectory[0][-1])
    planner.plan(_to(0.0, 1.0))
    _advance(execution, 1, time)
    assert first() is not None
    planner.plan(_to(1.0, 1.0))
    assert first() is None
