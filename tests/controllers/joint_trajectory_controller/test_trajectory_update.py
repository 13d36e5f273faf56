"""Time passes along a trajectory, and the joint is commanded along it."""

import pytest
from hypothesis import given, strategies as st

from station.controllers.joint_trajectory_controller.execution import (
    JointTracking,
    SpeedScaling,
    TrajectoryExecution,
    TrajectoryUpdate,
)
from station.controllers.joint_trajectory_controller.planning import TrajectoryPlanner
from station.controllers.set_point_controller import DirectLaw
from station.core.description.robot_description import JointDescription
from station.core.hardware.interfaces import JointStateGroup, JointStateHandle
from station.core.trajectory import JointTrajectory, JointTrajectoryPoint
from station.memory.doubles import zeros
from tests.both_modes import assert_same, needs_both


class Run:
    """An update along a line of 1 m in 10 s, and what it commands."""

    def __init__(self) -> None:
        joints, self.commands = [JointDescription("a")], zeros(1)
        state = JointStateHandle("a", zeros(1), zeros(1), zeros(1))
        self.tracking = JointTracking(joints, JointStateGroup([state]))
        self.execution = TrajectoryExecution(joints, self.tracking)
        law = DirectLaw(self.tracking.positions, self.commands)
        self.update = TrajectoryUpdate(self.execution, law, self.commands)
        self.execution.start(100.0)
        self.update.command_joints(100.5, 0.5)
        self.planner = TrajectoryPlanner(self.execution, joints)
        point = JointTrajectoryPoint([1.0], time_from_start=10.0)
        self.planner.plan(JointTrajectory(["a"], [point], stamp=101.0))


@pytest.fixture
def run():
    return Run()


def test_time_passes_and_the_joint_follows(run):
    for cycle in range(5):
        run.update.command_joints(101.0 + 0.5 * cycle, 0.5)
    assert [*run.commands] == pytest.approx([0.2])
    assert run.execution.moment == (103.0, 0.5, 3_000_000_000)
    assert [*run.execution.times_from_start] == [0.0, 2.0]
    assert run.update.sampled.newest[0] == 103.0


def test_a_trajectory_that_is_over_rests_at_its_end(run):
    for cycle in range(30):
        run.update.command_joints(101.0 + 0.5 * cycle, 0.5)
    assert [*run.commands] == pytest.approx([1.0])
    assert [*run.tracking.velocities] == [0.0]


def test_a_request_is_taken_up_in_the_next_cycle(run):
    run.update.command_joints(101.0, 0.5)
    run.update.command_joints(101.5, 0.5)
    run.execution.hold()
    assert len(run.execution.requests) == 1
    run.update.command_joints(102.0, 0.5)
    assert not run.execution.requests
    assert [*run.commands] == pytest.approx([0.05])


def test_the_speed_changes_by_its_ramp():
    speed = SpeedScaling(1.0, 0.5)
    speed.target = 0.0
    passed = [speed.advance(0.2) for _ in range(4)]
    assert passed == pytest.approx([0.2 * 0.8, 0.2 * 0.4, 0.2 * 0.1, 0.0])
    assert (speed.factor, speed.rate) == (0.0, 0.0)


@needs_both
@given(
    st.floats(0.0, 1.0),
    st.floats(0.0, 1.0),
    st.floats(0.0, 2.0),
    st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8),
)
def test_both_modes_change_the_speed_the_same(first, target, ramp, periods):
    def scenario(module):
        speed = module.SpeedScaling(first, ramp)
        speed.target = target
        found = []
        for period in periods:
            found += [speed.advance(period), speed.factor, speed.rate]
        return found

    assert_same("execution", scenario)
