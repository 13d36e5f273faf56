"""Hands trials to an executor and keeps what comes back."""

import os
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from multiprocessing import get_context
from typing import ParamSpec, TypeVar

from typing_extensions import override

from station.experiments.errors import ExperimentError, WorkerMismatchError
from station.experiments.results import Results
from station.experiments.trial import Trial, TrialResult
from station.experiments.workers import Identity, begin_worker, identity, run_trial

P = ParamSpec("P")
T = TypeVar("T")

NICENESS = 10
"""How much lower the priority of worker processes is: they never delay a station."""
_AHEAD = 4
"""Trials in hand per worker: enough to keep it busy, too few to need memory."""
_ATTEMPTS = 5
"""How often a trial is given away again after its worker was lost or refused."""


@dataclass(slots=True)
class Progress:
    """How far an experiment is.

    Attributes:
        total: How many trials it has.
        ended: How many have ended, the ones of earlier runs among them.
        failed: How many of those that ended in this run have failed.
        resumed: How many had ended before this run.
        repeated: How often a trial was given away again.
        refused: Why workers were refused, each reason once.
        is_interrupted: Whether Ctrl-C ended it early.
    """

    total: int
    ended: int = 0
    failed: int = 0
    resumed: int = 0
    repeated: int = 0
    refused: list[str] = field(default_factory=list)
    is_interrupted: bool = False


Watcher = Callable[[Progress], None]


class InThisProcess(Executor):
    """Runs what is submitted at once, in the caller's thread."""

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


def make_pool(workers: int | None = None) -> Executor:
    """Return worker processes of low priority.

    Args:
        workers: How many, >= 1; one per processor when None; with 0, trials run in
            this process.

    Raises:
        ExperimentError: The number is negative.
    """
    count = len(os.sched_getaffinity(0)) if workers is None else workers
    if count < 0:
        raise ExperimentError(
            f"There cannot be {count} workers; allowed are 0 or more."
        )
    if count == 0:
        return InThisProcess()
    # A fork would copy locks and MuJoCo's memory in whatever state they are.
    return ProcessPoolExecutor(
        count, get_context("spawn"), initializer=begin_worker, initargs=(NICENESS,)
    )


def worker_count(executor: Executor) -> int:
    """Return how many trials an executor can run at the same time, as far as known."""
    for name in ("worker_count", "_max_workers"):
        known = getattr(executor, name, None)
        if isinstance(known, int):
            return known
    return 1


class Runner:
    """Runs trials on an executor; every trial that ends is in the results at once.

    Trials that the results have already are not run again, so that an experiment that
    was interrupted or killed goes on where it was.

    Args:
        results: Where the trials are kept.
        executor: Where they run; its owner shuts it down.
        watch: Is told after every trial.
    """

    def __init__(
        self, results: Results, executor: Executor, watch: Watcher = lambda _: None
    ) -> None:
        self._results = results
        self._executor = executor
        self._watch = watch
        self._expected: Identity | None = None

    def run(self, trials: Iterable[Trial], total: int) -> Progress:
        """Run trials until all have ended or Ctrl-C.

        Args:
            trials: The trials, all of the results' setup; taken as they are needed.
            total: How many there are, for the progress.

        Raises:
            ExperimentError: Workers die or refuse again and again; what has ended is
                kept.
            StationError: The setup cannot be used.
        """
        progress = Progress(total)
        waiting: dict[Future[TrialResult], tuple[Trial, int]] = {}
        left = self._not_ended(trials, progress)
        try:
            while self._fill(waiting, left) or waiting:
                done, _ = wait(waiting, return_when=FIRST_COMPLETED)
                # In the order in which they were given away: sets have none.
                for future in [one for one in waiting if one in done]:
                    self._collect(future, waiting, progress)
        except KeyboardInterrupt:
            progress.is_interrupted = True
            self._let_run_end(waiting, progress)
        except BaseException:
            for future in waiting:
                future.cancel()
            raise
        return progress

    def _not_ended(
        self, trials: Iterable[Trial], progress: Progress
    ) -> Iterator[Trial]:
        for trial in trials:
            if self._results.find(trial.hash) is None:
                yield trial
            else:
                progress.ended += 1
                progress.resumed += 1
                self._watch(progress)

    def _fill(
        self,
        waiting: dict[Future[TrialResult], tuple[Trial, int]],
        left: Iterator[Trial],
    ) -> bool:
        """Give trials away until enough are in hand; return whether one was given."""
        has_given = False
        while len(waiting) < _AHEAD * worker_count(self._executor):
            trial = next(left, None)
            if trial is None:
                break
            self._give(trial, 1, waiting)
            has_given = True
        return has_given

    def _give(
        self,
        trial: Trial,
        attempt: int,
        waiting: dict[Future[TrialResult], tuple[Trial, int]],
    ) -> None:
        text = self._results.setup.text
        if self._expected is None:
            self._expected = identity(text)
        future = self._executor.submit(run_trial, text, trial.to_json(), self._expected)
        waiting[future] = (trial, attempt)

    def _collect(
        self,
        future: Future[TrialResult],
        waiting: dict[Future[TrialResult], tuple[Trial, int]],
        progress: Progress,
    ) -> None:
        """Keep the result of a trial, or give the trial away again.

        Raises:
            ExperimentError: It was given away too often.
        """
        trial, attempt = waiting.pop(future)
        try:
            result = future.result()
        except BrokenProcessPool as error:
            raise ExperimentError(
                "A worker process died, and the others with it.",
                remedy="All trials that ended are kept: repeat the command to go on. "
                "The machine may be short of memory; try fewer --workers.",
            ) from error
        except (WorkerMismatchError, CancelledError) as error:
            reason = str(error) or "A worker was lost."
            if reason not in progress.refused:
                progress.refused.append(reason)
            if attempt >= _ATTEMPTS:
                raise ExperimentError(
                    f"Trial {trial.hash} was given away {attempt} times: {reason}",
                    remedy="All trials that ended are kept: repeat the command when "
                    "the workers are in order.",
                ) from error
            progress.repeated += 1
            time.sleep(0.1 * attempt)  # a cluster needs a moment to see what it lost
            self._give(trial, attempt + 1, waiting)
            return
        if self._results.add(trial, result):
            progress.ended += 1
            progress.failed += result.state == "failed"
        self._watch(progress)

    def _let_run_end(
        self, waiting: dict[Future[TrialResult], tuple[Trial, int]], progress: Progress
    ) -> None:
        """Keep the trials that run; the others are taken back."""
        for future in list(waiting):
            if future.cancel():
                del waiting[future]
        for future in wait(waiting, timeout=60.0).done:
            self._collect(future, waiting, progress)
