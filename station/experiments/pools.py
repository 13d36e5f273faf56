"""Executors of trials on this machine, and the trials in a worker's process.

A pool has processes of low priority, or this one. A worker keeps its worlds between
trials. Arguments are plain text, so that any executor can send them to a worker.
"""

import atexit
import os
import platform
import signal
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, fields
from importlib.metadata import version
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.process import BaseProcess
from typing import ParamSpec, TypeVar

import mujoco
from typing_extensions import override

from station.compiled import source_digest
from station.experiments.trial_world import TrialWorld
from station.trials.errors import ExperimentError, WorkerMismatchError
from station.trials.trial import Setup, Trial, TrialResult

P = ParamSpec("P")
T = TypeVar("T")

NICENESS = 10
"""Niceness of processes that run trials, so that they do not delay a station."""
_WORLDS = 2
"""Number of worlds that a worker keeps."""
WORKER = f"{platform.node()}:{os.getpid()}"
"""Name of this process: host and process number."""
_one_at_a_time = threading.Lock()
"""Lock, because a worker of a cluster may have several threads, but a world allows one.
"""
_checked: set[str] = set()
"""Setups for which this process was found equal to the caller."""
_worlds: "OrderedDict[str, TrialWorld]" = OrderedDict()


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


@dataclass(frozen=True, slots=True)
class Identity:
    """Versions and digests that must agree on all machines of an experiment.

    Attributes:
        station: Version of the station, and a digest of its arithmetic.
        mujoco: Version of MuJoCo.
        setup: Digest of the setup as the worker has read it, and of the robot, which
            comes from files on the worker's machine.
    """

    station: str
    mujoco: str
    setup: str


def identity(setup_text: str) -> Identity:
    """Return the versions and digests of this process for a setup.

    Raises:
        StationError: The setup cannot be used here.
    """
    world = kept_world(Setup(setup_text))
    return Identity(
        f"{version('control-station')}+{source_digest()[:12]}",
        mujoco.mj_versionString(),
        f"{world.setup.digest}+{world.robot_digest}",
    )


def run_trials(
    setup_text: str, trial_texts: Sequence[str], expected: Identity | None = None
) -> list[TrialResult]:
    """Run trials one after the other; the result of a failed trial has its error.

    Args:
        setup_text: Text of the setup.
        trial_texts: `Trial.to_json` of each trial.
        expected: Versions and digests that the trials need; None accepts any.

    Raises:
        WorkerMismatchError: This process has another version or configuration than
            `expected`.
        StationError: The setup cannot be used here.
    """
    with _one_at_a_time:
        if expected is not None and setup_text not in _checked:
            compare(expected, identity(setup_text), WORKER)
            _checked.add(setup_text)
        setup = Setup(setup_text)
        world = kept_world(setup)
        return [world.run(Trial.from_json(setup, text)) for text in trial_texts]


def compare(expected: Identity, found: Identity, worker: str) -> None:
    """Refuse a worker that would compute other results.

    Raises:
        WorkerMismatchError: This process would give other results; the message says
            why.
    """
    for field in fields(Identity):
        wanted, has = getattr(expected, field.name), getattr(found, field.name)
        if wanted != has:
            raise WorkerMismatchError(
                f"Worker {worker} has {field.name} {has}; the experiment has {wanted}.",
                remedy="Install the same versions and files there, and start it again.",
                details={"worker": worker, "what": field.name},
            )


def be_polite(niceness: int) -> None:
    """Lower the priority of this process, unless it is already as low.

    Args:
        niceness: The niceness to have, 0 to 19.
    """
    # A process inherits the priority of the station's thread that starts it, which may
    # be high.
    present = os.getpriority(os.PRIO_PROCESS, 0)
    os.setpriority(os.PRIO_PROCESS, 0, max(niceness, present))


def begin_worker(niceness: int) -> None:
    """Prepare a worker process: set its niceness, and let it end with its parent.

    Args:
        niceness: The niceness to have, 0 to 19.
    """
    be_polite(niceness)
    # End without taking the kept worlds apart, because Ruckig prints a page of warnings
    # about what is left of them. All results have been sent by then.
    atexit.register(os._exit, 0)
    # Ignore Ctrl-C, because the parent handles it: the running trials may end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: BaseProcess) -> None:
    """End this process when its parent has ended, for whatever reason."""
    parent.join()
    os._exit(1)


def kept_world(setup: Setup) -> TrialWorld:
    """Return the world of a setup; build it if this process does not keep it yet."""
    world = _worlds.pop(setup.digest, None)
    if world is None:
        world = TrialWorld(setup)
    _worlds[setup.digest] = world
    while len(_worlds) > _WORLDS:
        _worlds.popitem(last=False)[1].close()
    return world
