"""Executors of trials on this machine: processes of low priority, or this one."""

import os
import signal
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context
from typing import ParamSpec, TypeVar

from typing_extensions import override

from station.experiments.workers import begin_worker
from station.trials.errors import ExperimentError

P = ParamSpec("P")
T = TypeVar("T")

NICENESS = 10
"""Niceness of processes that run trials, so that they do not delay a station."""


class InThisProcess(Executor):
    """Runs submitted work at once, in the caller's thread."""

    @override
    def submit(
        self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs
    ) -> Future[T]:
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # noqa: BLE001 - the caller of result() gets it
            future.set_exception(error)
        return future


class ProcessPool(Executor):
    """Worker processes; when one of them dies, new processes replace all.

    The pool of the standard library cannot be used after a process has died: all its
    futures end with `BrokenProcessPool`. This pool starts a new one at the next
    `submit`, so that the caller can submit the lost work again.

    Args:
        workers: Number of processes, >= 1.

    Attributes:
        worker_count: Number of processes.
    """

    def __init__(self, workers: int) -> None:
        self.worker_count = workers
        self._pool = self._begin()

    @override
    def submit(
        self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs
    ) -> Future[T]:
        with _no_interrupts():
            try:
                return self._pool.submit(fn, *args, **kwargs)
            except BrokenProcessPool:
                self._pool.shutdown(wait=True)
                self._pool = self._begin()
                return self._pool.submit(fn, *args, **kwargs)

    @override
    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self._pool.shutdown(wait, cancel_futures=cancel_futures)

    def abandon(self) -> None:
        """End this program's worker processes at once; their work is lost."""
        self._pool.shutdown(wait=False, cancel_futures=True)
        for process in active_children():
            process.kill()

    def _begin(self) -> ProcessPoolExecutor:
        # A fork would copy locks and MuJoCo's memory in an undefined state.
        return ProcessPoolExecutor(
            self.worker_count,
            get_context("spawn"),
            initializer=begin_worker,
            initargs=(NICENESS,),
        )


@contextmanager
def _no_interrupts() -> Iterator[None]:
    """Block SIGINT in this thread, and in processes that it starts meanwhile.

    Ctrl-C goes to all processes of a terminal. A worker ignores SIGINT as soon as
    `begin_worker` runs; until then, while it imports modules, SIGINT must not kill it.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def make_pool(workers: int | None = None) -> Executor:
    """Return worker processes of low priority.

    Args:
        workers: Number of processes, >= 1; None for one per processor; 0 runs trials in
            this process.

    Raises:
        ExperimentError: The number is negative.
    """
    count = len(os.sched_getaffinity(0)) if workers is None else workers
    if count < 0:
        raise ExperimentError(
            f"There cannot be {count} workers; allowed are 0 or more."
        )
    return ProcessPool(count) if count else InThisProcess()


def worker_count(executor: Executor) -> int:
    """Return the number of trials that an executor runs at once, if known."""
    for name in ("worker_count", "_max_workers"):
        known = getattr(executor, name, None)
        if isinstance(known, int):
            return known
    return 1


def losses(executor: Executor) -> tuple[type[BaseException], ...]:
    """Return the exception types of a future whose worker process has died."""
    return (BrokenProcessPool, *getattr(executor, "worker_losses", ()))


def refusals(executor: Executor) -> Mapping[str, str]:
    """Return the reasons for giving workers no work, by address; empty if local."""
    found: Mapping[str, str] = getattr(executor, "refused", {})
    return found
