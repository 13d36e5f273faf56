"""Outcomes are decided in the control thread and carried out elsewhere."""

import pytest

from station.core.ports.goal import Goal, GoalResult, GoalStatus
from station.core.toolbox.realtime import RealtimeServerGoalHandle


@pytest.fixture
def goal():
    goal = Goal("1", {})
    goal.status = GoalStatus.ACTIVE
    return goal


@pytest.fixture
def feedback():
    return []


@pytest.fixture
def handle(goal, feedback):
    return RealtimeServerGoalHandle(goal, feedback.append)


@pytest.mark.parametrize(
    ("method", "status"),
    [("set_aborted", GoalStatus.ABORTED), ("set_succeeded", GoalStatus.SUCCEEDED)],
)
def test_an_outcome_is_carried_out_by_the_other_thread(handle, goal, method, status):
    result = GoalResult(1, "because")

    getattr(handle, method)(result)
    assert goal.status is GoalStatus.ACTIVE
    handle.run_non_realtime()

    assert goal.status is status
    assert goal.result is result


def test_a_goal_is_canceled_only_when_somebody_asked(handle, goal):
    handle.set_canceled(GoalResult())
    handle.run_non_realtime()
    assert goal.status is GoalStatus.ACTIVE

    goal.cancel_requested = True
    handle.run_non_realtime()

    assert goal.status is GoalStatus.PREEMPTED


def test_the_first_outcome_counts(handle, goal):
    handle.set_succeeded(GoalResult())
    handle.set_aborted(GoalResult(1, "too late"))
    handle.run_non_realtime()

    assert goal.status is GoalStatus.SUCCEEDED


def test_the_newest_feedback_is_published_while_the_goal_is_active(handle, feedback):
    handle.run_non_realtime()
    handle.set_feedback(0.1)
    handle.set_feedback(0.2)
    handle.run_non_realtime()
    handle.set_succeeded(GoalResult())
    handle.run_non_realtime()
    handle.run_non_realtime()

    assert feedback == [0.2, 0.2]


@pytest.mark.parametrize(
    "status", [s for s in GoalStatus if s is not GoalStatus.ACTIVE]
)
def test_a_goal_that_is_not_active_is_left_alone(handle, goal, status):
    goal.status = status
    handle.set_aborted(GoalResult(1))

    handle.run_non_realtime()

    assert goal.status is status
