"""Publishing out of the control thread by a thread that does the slow part.

Source: realtime_tools@noetic-devel realtime_publisher.h; differs: messages that are
dropped and calls that failed are counted.
"""

import threading
import traceback
from collections.abc import Callable
from queue import SimpleQueue
from types import TracebackType
from typing import Generic, TypeVar

T = TypeVar("T")


class RealtimePublisher(Generic[T]):
    """Calls `publish` with messages of the control thread, in a thread of its own.

    Takes one message at a time: while one waits to be picked up, further ones are
    dropped. The thread runs from `start` to `stop`; a context manager does both.

    Args:
        publish: What to do with a message; may be slow.
        name: Name of the thread.

    Attributes:
        dropped: Number of messages dropped so far.
        failed: Number of calls of `publish` that raised.
        failure: Traceback of the last of them; empty if none did.
    """

    def __init__(self, publish: Callable[[T], None], name: str = "publisher") -> None:
        self._publish = publish
        self._name = name
        # Its `put` never waits; `_free` keeps it from holding more than one message.
        self._queue: SimpleQueue[T | None] = SimpleQueue()
        self._free = True
        self._thread: threading.Thread | None = None
        self.dropped = 0
        self.failed = 0
        self.failure = ""

    def try_publish(self, message: T) -> bool:
        """Hand over `message`, which nobody changes afterwards; never waits.

        Control thread only.

        Returns:
            Whether it was taken; False when it was dropped.
        """
        if not self._free:
            self.dropped += 1
            return False
        self._free = False
        self._queue.put(message)
        return True

    def start(self) -> None:
        """Begin to publish; does nothing when it has begun."""
        if self._thread is None:
            self._thread = threading.Thread(
                target=self._run, name=self._name, daemon=True
            )
            self._thread.start()

    def stop(self) -> None:
        """Publish what was handed over and end; waits for a slow `publish`."""
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
            except Exception:  # noqa: BLE001 - counted and kept for who looks
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
