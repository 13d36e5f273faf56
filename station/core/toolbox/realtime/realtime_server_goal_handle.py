"""A goal that the control thread ends and another thread reports.

Source: realtime_tools@noetic-devel realtime_server_goal_handle.h.
"""

from collections.abc import Callable
from typing import Generic, TypeVar

from station.core.ports.goal import Goal, GoalResult, GoalStatus

FeedbackT = TypeVar("FeedbackT")


class RealtimeServerGoalHandle(Generic[FeedbackT]):
    """Take the outcome from the control thread; `run_non_realtime` reports it.

    The first outcome counts. A goal is canceled only if its cancellation was requested.

    Args:
        goal: The goal.
        publish_feedback: Called with the newest feedback while the goal is active.
    """

    def __init__(
        self, goal: Goal, publish_feedback: Callable[[FeedbackT], None]
    ) -> None:
        self.goal = goal
        self._publish_feedback = publish_feedback
        self._outcome: tuple[GoalStatus, GoalResult] | None = None
        self._feedback: FeedbackT | None = None

    def set_aborted(self, result: GoalResult) -> None:
        """End the goal without success; control thread."""
        self._end(GoalStatus.ABORTED, result)

    def set_canceled(self, result: GoalResult) -> None:
        """End the goal because its cancellation was requested; control thread."""
        self._end(GoalStatus.PREEMPTED, result)

    def set_succeeded(self, result: GoalResult) -> None:
        """End the goal with success; control thread."""
        self._end(GoalStatus.SUCCEEDED, result)

    def set_feedback(self, feedback: FeedbackT) -> None:
        """Replace the feedback that is published next; control thread."""
        self._feedback = feedback

    def run_non_realtime(self) -> None:
        """Report the outcome and publish feedback; not in the control thread."""
        goal, outcome = self.goal, self._outcome
        if goal.status is not GoalStatus.ACTIVE:
            return
        if outcome is not None:
            status, result = outcome
            if status is not GoalStatus.PREEMPTED or goal.cancel_requested:
                goal.finish(status, result)
        # As in the original: feedback of a goal that has just ended is still sent.
        feedback = self._feedback
        if feedback is not None:
            self._publish_feedback(feedback)

    def _end(self, status: GoalStatus, result: GoalResult) -> None:
        if self._outcome is None:
            self._outcome = (status, result)
