"""Goals: their life, their list, and how they are cancelled."""

import pytest

from station.core.errors import ControllerStateError, GoalNotFoundError
from station.core.ports.goal import Goal, GoalPort, GoalResult, GoalStatus


class Port(GoalPort):
    """Accepts everything."""

    def submit(self, request, ticket=None):
        goal = self.new_goal(request)
        self.remember(goal)
        return goal


def test_a_goal_ends_once():
    goal = Goal("1", {})
    assert not goal.is_final()
    goal.finish(GoalStatus.ABORTED, GoalResult(-4, "too far"))
    goal.finish(GoalStatus.SUCCEEDED, GoalResult())
    assert goal.is_final()
    assert goal.status is GoalStatus.ABORTED
    assert goal.result == GoalResult(-4, "too far")


def test_goals_have_names_and_are_found_by_them():
    port = Port()
    first, second = port.submit({"a": 1}), port.submit({})
    assert first.identifier != second.identifier
    assert port.get(first.identifier) is first
    assert port.goals() == [first, second]
    with pytest.raises(GoalNotFoundError) as caught:
        port.get("99")
    assert caught.value.remedy == "Known goals: 1, 2."


def test_cancelling_is_a_wish():
    port = Port()
    goal = port.submit({})
    assert port.cancel(goal.identifier) is goal
    assert goal.cancel_requested
    assert not goal.is_final()


def test_only_the_latest_goals_are_kept():
    port = Port()
    for _ in range(60):
        port.submit({})
    assert len(port.goals()) == 50
    with pytest.raises(GoalNotFoundError):
        port.get("1")


def test_voiding_ends_all_goals_and_asks_their_controller_to_stop():
    port = Port()
    done, waiting = port.submit({}), port.submit({})
    done.finish(GoalStatus.SUCCEEDED, GoalResult())

    port.void("A reset.")

    assert done.status is GoalStatus.SUCCEEDED
    assert waiting.status is GoalStatus.PREEMPTED
    assert waiting.result == GoalResult(0, "A reset.")
    assert waiting.cancel_requested


def test_aborting_ends_all_goals_that_had_not_ended():
    port = Port()
    done, waiting = port.submit({}), port.submit({})
    done.finish(GoalStatus.SUCCEEDED, GoalResult())

    port.abort("A reflex.")

    assert done.status is GoalStatus.SUCCEEDED
    assert waiting.status is GoalStatus.ABORTED
    assert waiting.result == GoalResult(0, "A reflex.")


def test_cancelling_a_goal_that_has_ended_changes_nothing():
    port = Port()
    done = port.submit({})
    done.finish(GoalStatus.SUCCEEDED, GoalResult())

    assert port.cancel(done.identifier) is done
    port.void("A reset.")
    assert not done.cancel_requested


def test_a_port_refuses_goals_while_its_controller_is_not_running():
    port = Port(is_running=lambda: False)
    with pytest.raises(ControllerStateError, match="not running"):
        port.submit({})
    assert port.goals() == []


def test_a_goal_has_the_feedback_of_its_port():
    goal = Port(feedback=lambda: {"position": 0.5}).submit({})
    assert goal.feedback() == {"position": 0.5}
