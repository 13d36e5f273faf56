"""Publish messages of the control thread in another thread, which may be slow.

Source: realtime_tools@noetic-devel realtime_publisher.h; differs: dropped messages and
failed calls are counted.
"""

import threading
import traceback
from collections.abc import Callable
from queue import SimpleQueue
from types import TracebackType
from typing import Generic, TypeVar

T = TypeVar("T")


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

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()
