"""Pass data between the control thread and other threads without waiting."""

import threading
import traceback
from collections.abc import Callable
from queue import SimpleQueue
from typing import Generic, TypeVar

from station.core.ports.goal import Goal, GoalResult, GoalStatus

T = TypeVar("T")


class RealtimeBox(Generic[T]):
    """Hold the newest value. Any thread may call the methods; none of them waits.

    All readers share the value, so it must not be changed after `set`: use a tuple or a
    frozen dataclass.

    Args:
        initial: The first value.

    Source:
        realtime_tools@noetic-devel realtime_box.h; differs: a reference is swapped, so
        that no thread locks and no thread waits.
    """

    def __init__(self, initial: T) -> None:
        self._value = initial

    def set(self, value: T) -> None:
        """Replace the value."""
        self._value = value

    def get(self) -> T:
        """Return the newest value."""
        return self._value


class RealtimeBuffer(Generic[T]):
    """Hand the newest value to the control thread, which sees whether it is new.

    A value must not be changed after it was written.

    Args:
        initial: The first value; it does not count as new.

    Source:
        realtime_tools@noetic-devel realtime_buffer.h; differs: a reference is swapped
        instead of two buffers under a lock, so that the control thread always gets the
        newest value.
    """

    def __init__(self, initial: T) -> None:
        self._newest = initial
        self._seen = initial

    def write_from_non_rt(self, value: T) -> None:
        """Replace the value; any thread but the control thread."""
        self._newest = value

    def read_from_non_rt(self) -> T:
        """Return the newest value; any thread but the control thread."""
        return self._newest

    def read_from_rt(self) -> T:
        """Return the newest value; control thread only, never waits."""
        self._seen = self._newest
        return self._seen

    def has_new(self) -> bool:
        """Return whether a value was written since `read_from_rt`; control thread."""
        return self._newest is not self._seen

    def init_rt(self, value: T) -> None:
        """Set a value that does not count as new; control thread, as in `starting`."""
        self._newest = self._seen = value


KEPT = 0.9999
"""Weight of the old estimate when a new measurement arrives, 0 to 1."""


class RealtimeClock:
    """Convert the control thread's time into system time, with jitter filtered out.

    Another thread calls `measure` with the system's time from time to time. The control
    thread calls `get_system_time` in every cycle and never waits.

    Source:
        realtime_tools@noetic-devel src/realtime_clock.cpp; differs: the clock has no
        thread of its own; its owner calls `measure`.
    """

    def __init__(self) -> None:
        self._measured: float | None = None
        self._offset: float | None = None
        self._last: float | None = None

    def measure(self, system_time: float) -> None:
        """Record the system's time [s]; any thread but the control thread."""
        self._measured = system_time

    def get_system_time(self, realtime_time: float) -> float:
        """Return the estimated system time [s]; control thread only.

        A measurement was taken at an unknown moment of the last cycle, on average in
        its middle, so half a cycle is added to it.

        Args:
            realtime_time: The control thread's time of this cycle [s].

        Returns:
            The estimate; `realtime_time` itself before the first measurement.
        """
        measured, self._measured = self._measured, None
        if measured is not None:
            last = self._last
            half = 0.0 if last is None else (realtime_time - last) / 2.0
            seen = measured + half - realtime_time
            offset = self._offset
            blended = KEPT * (offset or 0.0) + (1.0 - KEPT) * seen
            self._offset = seen if offset is None else blended
        self._last = realtime_time
        return realtime_time + (self._offset or 0.0)


class RealtimePublisher(Generic[T]):
    """Call `publish` with messages of the control thread, in a thread of its own.

    The publisher takes one message at a time and drops further ones until that one is
    picked up. The thread runs from `start` to `stop`; the context manager calls both.

    Args:
        publish: Publishes a message; may be slow.
        name: Name of the thread.

    Attributes:
        dropped: Number of messages dropped so far.
        failed: Number of calls of `publish` that raised an exception.
        failure: Traceback of the last such call; None if there was none.

    Source:
        realtime_tools@noetic-devel realtime_publisher.h; differs: dropped messages and
        failed calls are counted.
    """

    def __init__(self, publish: Callable[[T], None], name: str = "publisher") -> None:
        self._publish = publish
        self._name = name
        # `SimpleQueue.put` never waits; `_free` keeps the queue at one message at most.
        self._queue: SimpleQueue[T | None] = SimpleQueue()
        self._free = True
        self._thread: threading.Thread | None = None
        self.dropped = 0
        self.failed = 0
        self.failure: str | None = None

    def try_publish(self, message: T) -> bool:
        """Hand over a message without waiting. Control thread only.

        Args:
            message: The message, which must not be changed afterwards.

        Returns:
            Whether the message was taken; False if it was dropped.
        """
        if not self._free:
            self.dropped += 1
            return False
        self._free = False
        self._queue.put(message)
        return True

    def start(self) -> None:
        """Start the thread, unless it runs already."""
        if self._thread is None:
            self._thread = threading.Thread(
                target=self._run, name=self._name, daemon=True
            )
            self._thread.start()

    def stop(self) -> None:
        """Publish the last message and end the thread; wait for a slow `publish`."""
        thread = self._thread
        if thread is not None:
            self._queue.put(None)
            thread.join()
            self._thread = None

    def _run(self) -> None:
        while True:
            message = self._queue.get()
            if message is None:
                return
            self._free = True
            try:
                self._publish(message)
            except Exception:  # noqa: BLE001 - counted, and kept in `failure`
                self.failed += 1
                self.failure = traceback.format_exc()

    def __enter__(self) -> "RealtimePublisher[T]":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


FeedbackT = TypeVar("FeedbackT")


class RealtimeServerGoalHandle(Generic[FeedbackT]):
    """Let the control thread end a goal; `run_non_realtime` reports the outcome.

    The first outcome counts. A goal is canceled only if its cancellation was requested.

    Args:
        goal: The goal.
        publish_feedback: Called with the newest feedback while the goal is active.

    Source:
        realtime_tools@noetic-devel realtime_server_goal_handle.h.
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
