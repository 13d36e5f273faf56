"""A stopwatch for promises: it stands while processes wait for a busy machine."""

import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

PAUSE = 0.02
"""Time between two looks [s]."""


class Stopwatch:
    """Measures how long what it encloses takes, with processors that are free.

    Linux counts for every thread how long it was ready and no processor took it. What
    the thread that waited longest has waited is taken off; sleeping, and waiting for
    locks and for other machines, is not.

    Args:
        roots: Processes; all that they have started belong to them.
    """

    def __init__(self, *roots: int) -> None:
        self._roots = roots
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look)
        self.seconds = 0.0
        """How long it took [s]."""

    def __enter__(self) -> Self:
        self._last, self._at = self._waited(), time.monotonic()
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._over.set()
        self._thread.join()

    def _look(self) -> None:
        is_over = False
        while not is_over:
            is_over = self._over.wait(PAUSE)
            waited, at = self._waited(), time.monotonic()
            longest = max(
                (s - self._last.get(t, 0.0) for t, s in waited.items()), default=0.0
            )
            self.seconds += at - self._at - longest
            self._last, self._at = waited, at

    def _waited(self) -> dict[Path, float]:
        """Return how long each thread has waited for a processor so far [s]."""
        waited = {}
        for task in _tasks(self._roots):
            with suppress(FileNotFoundError, ProcessLookupError):
                waited[task] = int((task / "schedstat").read_text().split()[1]) / 1e9
        return waited


def _tasks(processes: tuple[int, ...]) -> Iterator[Path]:
    """Yield the folders of all threads of processes, and of those they have started."""
    for process in processes:
        # Processes and threads may end at any time.
        with suppress(FileNotFoundError, ProcessLookupError):
            for task in Path(f"/proc/{process}/task").iterdir():
                yield task
                children = (task / "children").read_text().split()
                yield from _tasks(tuple(map(int, children)))
