"""Goals: requests that take time, report progress and end with a result.

Source: actionlib_msgs/GoalStatus.msg; differs: a goal is an object of the process, not
a pair of topics, and a refused goal is an exception.
"""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from station.core.errors import ControllerStateError, GoalNotFoundError
from station.core.ports.command_ticket import CommandTicket

_KEPT_GOALS = 50


class GoalStatus(Enum):
    """The states of a goal. The last three are final."""

    PENDING = "pending"
    ACTIVE = "active"
    PREEMPTED = "preempted"
    SUCCEEDED = "succeeded"
    ABORTED = "aborted"


@dataclass(frozen=True, slots=True)
class GoalResult:
    """The outcome of a goal.

    Attributes:
        code: The number that the action defines for this end; 0 for success, and for a
            goal that was ended from outside its controller.
        message: One sentence for people; empty on success.
        details: The facts of the message (JSON-compatible values).
    """

    code: int = 0
    message: str = ""
    details: Mapping[str, object] = field(default_factory=dict)


class Goal:
    """One goal. Its controller changes it in the control thread; any thread may read.

    Args:
        identifier: Name of the goal within the controller.
        request: The goal message.

    Attributes:
        status: State of the goal.
        progress: Part of the goal's time that has passed, 0 to 1.
        result: How the goal ended; None until then.
        cancel_requested: Whether the goal was asked to end.
        cancel_reason: Why it was asked to end, in one sentence.
        ticket: Notes the cycle in which the controller takes the goal; None if that
            cycle is noted nowhere.
        ended: Notes the cycle in which the goal ends on request; None if that cycle is
            noted nowhere.
        feedback: Returns the action's feedback message (JSON-compatible values), which
            is empty unless the controller replaces this function. Any thread.
        explain: Returns a sentence to end the message of an abort with, or an empty
            text. Control thread.
    """

    def __init__(self, identifier: str, request: Mapping[str, object]) -> None:
        self.identifier = identifier
        self.request = request
        self.status = GoalStatus.PENDING
        self.progress = 0.0
        self.result: GoalResult | None = None
        self.cancel_requested = False
        self.cancel_reason = "The goal was cancelled."
        self.ticket: CommandTicket | None = None
        self.ended: CommandTicket | None = None
        self.feedback: Callable[[], Mapping[str, object]] = dict
        self.explain: Callable[[], str] = str

    def is_final(self) -> bool:
        """Return whether the goal has ended."""
        return self.status not in {GoalStatus.PENDING, GoalStatus.ACTIVE}

    def finish(self, status: GoalStatus, result: GoalResult) -> None:
        """End the goal; a goal that has ended stays as it is."""
        if self.is_final():
            return
        if status is GoalStatus.ABORTED and (reason := self.explain()):
            result = replace(result, message=f"{result.message} {reason}".strip())
        self.result = result
        self.status = status
        if self.ended is not None and status is GoalStatus.PREEMPTED:
            self.ended.accept()

    def ask_to_end(self, reason: str | None = None) -> bool:
        """Ask the controller to end the goal in its next cycle. Callable in any thread.

        Args:
            reason: The reason, in one sentence; None when a client cancels it.

        Returns:
            Whether the goal had not ended yet.
        """
        if self.is_final():
            return False
        if reason is not None:
            self.cancel_reason = reason
        self.cancel_requested = True
        return True

    def withdraw(self, reason: str) -> None:
        """End the goal from outside its controller, whether it has begun or not.

        Callable from any thread: a controller that takes the goal up at the same time
        sees `cancel_requested` and ends the motion. A goal that has ended stays as it
        is.

        Args:
            reason: Why the goal ends, in one sentence.
        """
        if self.is_final():
            return
        self.cancel_requested = True
        self.finish(GoalStatus.PREEMPTED, GoalResult(0, reason))


class GoalPort(ABC):
    """The port of a controller for goals. Any thread may call all methods.

    Args:
        is_running: Returns whether the controller is running; None for a port that
            takes goals at any time.
        feedback: Returns the feedback message of the active goal.
    """

    def __init__(
        self,
        is_running: Callable[[], bool] | None = None,
        feedback: Callable[[], Mapping[str, object]] = dict,
    ) -> None:
        self._is_running = is_running
        self._feedback = feedback
        self._goals: deque[Goal] = deque(maxlen=_KEPT_GOALS)
        self._count = 0

    @abstractmethod
    def submit(
        self, request: Mapping[str, object], ticket: CommandTicket | None = None
    ) -> Goal:
        """Check a request and hand it to the controller.

        Args:
            request: The goal message of the action as JSON-compatible values.
            ticket: Notes the cycle that takes the goal.

        Returns:
            The accepted goal; the controller takes it up in its next cycle.

        Raises:
            StationError: The goal cannot be accepted; nothing changed.
        """

    def goals(self) -> list[Goal]:
        """Return the latest goals, oldest first."""
        return list(self._goals)

    def get(self, identifier: str) -> Goal:
        """Return the goal called `identifier`.

        Raises:
            GoalNotFoundError: There is no such goal among the last 50.
        """
        for goal in self.goals():
            if goal.identifier == identifier:
                return goal
        known = ", ".join(goal.identifier for goal in self.goals())
        raise GoalNotFoundError(
            f"There is no goal '{identifier}'.",
            remedy=f"Known goals: {known or 'none'}.",
        )

    def cancel(self, identifier: str) -> Goal:
        """Ask a goal to end; the controller ends it in its next cycle.

        A goal that has ended stays as it is.

        Raises:
            GoalNotFoundError: There is no such goal among the last 50.
        """
        goal = self.get(identifier)
        goal.ask_to_end()
        return goal

    def void(self, reason: str) -> None:
        """End every goal from outside its controller. Callable from any thread.

        Args:
            reason: Why the goals end, in one sentence.
        """
        for goal in self.goals():
            goal.withdraw(reason)

    def abort(self, reason: str) -> None:
        """End every goal because its controller cannot continue. Control thread.

        Args:
            reason: Why the controller cannot continue, in one sentence.
        """
        for goal in self.goals():
            goal.finish(GoalStatus.ABORTED, GoalResult(0, reason))

    def new_goal(
        self, request: Mapping[str, object], ticket: CommandTicket | None = None
    ) -> Goal:
        """Return a goal with a new name, which `goals` does not list yet.

        Args:
            request: The goal message.
            ticket: Notes the cycle that takes the goal.

        Raises:
            ControllerStateError: The controller is not running.
        """
        if self._is_running is not None and not self._is_running():
            raise ControllerStateError(
                "The controller is not running; only a running controller takes goals.",
                remedy="Start the controller first.",
            )
        self._count += 1
        goal = Goal(str(self._count), request)
        goal.feedback = self._feedback
        goal.ticket = ticket
        return goal

    def remember(self, goal: Goal) -> None:
        """Add an accepted goal to those that `goals` lists."""
        self._goals.append(goal)
