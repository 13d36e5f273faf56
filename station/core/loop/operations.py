"""Operations of other threads, carried out by the control thread between cycles."""

import threading
from collections import deque
from collections.abc import Callable, Mapping
from typing import TypeVar

from station.core.errors import LoopError

T = TypeVar("T")

# Each operation may take a part of the period; more of them would make a cycle late.
OPERATIONS_PER_CYCLE = 4
"""Number of posted operations that a cycle carries out; the rest wait for the next."""


class Operation:
    """An action between two cycles, and its outcome for the waiting caller.

    Args:
        action: Short, and must not wait for anything.

    Attributes:
        result: Result of `action`.
        error: Error of `action`, or the reason why it will never run; None if neither.
        abandoned: Whether its caller has stopped waiting; the action then does not run.
        done: A lock that is released once `result` or `error` is set.
    """

    def __init__(self, action: Callable[[], object]) -> None:
        self._action = action
        self.result: object = None
        self.error: BaseException | None = None
        self.abandoned = False
        # Released by the control thread, which never waits for it.
        self.done = threading.Lock()
        self.done.acquire()

    def run_operation(self) -> None:
        """Carry the operation out, unless its caller has given up."""
        if not self.abandoned:
            try:
                self.result = self._action()
            except BaseException as error:  # noqa: BLE001 - handed to the caller
                self.error = error
        self.done.release()

    def outcome(self, timeout: float, details: Mapping[str, object]) -> object:
        """Wait for the end of the action; return its result, or raise its error.

        Args:
            timeout: How long to wait [s wall time].
            details: Facts about the loop, for the error.

        Raises:
            LoopError: The action was not run in time, and will not be run later.
        """
        if not self.done.acquire(timeout=timeout):
            # A caller that got an error must not find the action carried out later.
            self.abandoned = True
            raise LoopError(
                f"The control loop did not answer within {timeout} s.",
                remedy="See the report of the loop: it is overloaded, or it has died.",
                details=dict(details),
            )
        if self.error is not None:
            raise self.error
        return self.result

    def give_up(self, error: LoopError) -> None:
        """End the wait of the caller with an error: the operation will never run."""
        self.error = error
        self.done.release()


class Operations:
    """The operations that wait for the next cycle. Any thread posts, one runs them.

    Attributes:
        waiting: The operations, oldest first.
    """

    def __init__(self) -> None:
        self.waiting: deque[Operation] = deque()

    def post(self, action: Callable[[], object]) -> Operation:
        """Have `action` carried out between two cycles."""
        operation = Operation(action)
        self.waiting.append(operation)
        return operation

    def run_operations(self) -> bool:
        """Run as many operations as a cycle has time for; return whether any ran."""
        waiting = self.waiting
        if not waiting:
            return False
        # Not `while waiting`: an operation may post another one.
        for _ in range(min(len(waiting), OPERATIONS_PER_CYCLE)):
            waiting.popleft().run_operation()
        return True

    def give_up(self, error: LoopError) -> None:
        """End the wait of all callers with an error: no operation will run."""
        while self.waiting:
            self.waiting.popleft().give_up(error)


def guarded(check: Callable[[], None], action: Callable[[], T]) -> Callable[[], T]:
    """Return a function that calls `check`, then returns the result of `action`.

    The check is made just before the action, because a stop may come after the request.

    Args:
        check: Raises if the action is not allowed.
        action: Operation that follows the check.
    """

    def act() -> T:
        check()
        return action()

    return act
