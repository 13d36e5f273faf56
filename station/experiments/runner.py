"""Submit trials to an executor, and keep their results."""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence, Sized
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from dataclasses import dataclass, field, replace
from itertools import islice
from math import inf

from station.experiments.pools import (
    Identity,
    identity,
    losses,
    refusals,
    run_trials,
    worker_count,
)
from station.trials.errors import ExperimentError, WorkerMismatchError
from station.trials.results import Results
from station.trials.trial import Trial, TrialResult

_AHEAD = 4
"""Submitted tasks per worker: enough to keep it busy, few enough to save memory."""
_TASK = 0.5
"""Aimed duration of a task of several trials [s]. Sending it to a worker of a cluster
and fetching the results takes about 10 ms (benchmarks/bench_experiments.py, `cluster`).
"""
_ATTEMPTS = 5
"""Most submissions of a trial, if workers refuse it or its worker leaves."""
_DEATHS = 5
"""Number of processes that may die one after the other; with more, the fault is not
that of a trial, and the experiment fails."""


@dataclass(slots=True)
class Progress:
    """The progress of an experiment.

    Attributes:
        total: Number of trials of the experiment.
        ended: Number of ended trials, including those of earlier runs.
        failed: Number of trials that have failed since the runner was made.
        resumed: Number of trials that had ended before this run.
        repeated: Number of repeated submissions since the runner was made.
        refused: Reasons for which workers were refused, each once.
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
_Waiting = dict[Future[list[TrialResult]], tuple[Sequence[Trial], int]]
"""The submitted tasks: the trials of each, and the number of its attempt."""


class Runner:
    """Runs trials on an executor; the results have each trial as soon as it ends.

    Short trials are submitted together in tasks of half a second; the results have them
    when the task ends.

    Trials that the results already have are not run again, so that an interrupted or
    killed experiment goes on where it ended.

    When a process dies, its submitted trials are lost. Each of them is run once more by
    itself. A trial whose process dies again has failed, and the others go on.

    Args:
        results: File of the trials.
        executor: Runs the trials; its owner shuts it down.
        watch: Called after every trial, after the refusal or loss of workers, and after
            Ctrl-C.
        sleep: Function that waits for a time [s], before a trial is submitted again.
    """

    def __init__(
        self,
        results: Results,
        executor: Executor,
        watch: Watcher = lambda _: None,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._results = results
        self._executor = executor
        self._watch = watch
        self._sleep = sleep
        self._expected: Identity | None = None
        self._losses = losses(executor)
        self._lost: list[Trial] = []
        self._has_one_ended = False
        self._deaths = 0
        self._longest = inf
        self._remaining = 0
        self._last = Progress(0)

    def run(self, trials: Iterable[Trial], total: int) -> Progress:
        """Run trials until all have ended or Ctrl-C.

        After Ctrl-C no further trial begins, and the running trials may end.

        Args:
            trials: The trials, which all have the setup of the results; they are read
                as needed.
            total: Number of trials of the experiment, for the progress; also the length
                of `trials` if it has none.

        Raises:
            ExperimentError: Workers die or refuse again and again; what has ended is
                kept.
            StationError: The setup cannot be used.
            KeyboardInterrupt: Ctrl-C came a second time.
        """
        progress = replace(self._last, total=total, ended=0, is_interrupted=False)
        self._last = progress
        self._lost.clear()
        self._remaining = len(trials) if isinstance(trials, Sized) else total
        waiting: _Waiting = {}
        left = self._not_ended(trials, progress)
        try:
            while self._fill(waiting, left) or waiting or self._lost:
                self._note_refusals(progress)
                if not waiting:
                    self._give(self._lost[:1], 1, waiting)
                done, _ = wait(waiting, return_when=FIRST_COMPLETED)
                # Collect in the order of submission, because a set has no order.
                for future in [one for one in waiting if one in done]:
                    self._collect(future, waiting, progress)
        except KeyboardInterrupt:
            progress.is_interrupted = True
            self._watch(progress)
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
            self._remaining -= 1
            if self._results.find(trial.hash) is None:
                yield trial
            else:
                progress.ended += 1
                progress.resumed += 1
                self._watch(progress)

    def _fill(self, waiting: _Waiting, left: Iterator[Trial]) -> bool:
        """Submit trials until enough tasks wait; return whether any was submitted.

        It submits none while lost trials wait: each of these must run by itself, to
        show whether its process dies of it.
        """
        if self._lost:
            return False
        has_given = False
        tasks = _AHEAD * worker_count(self._executor)
        while len(waiting) < tasks:
            # Spread the last trials over all workers.
            share = self._remaining // tasks
            quick = int(_TASK / self._longest) if self._longest > 0.0 else share
            task = list(islice(left, max(1, min(share, quick))))
            if not task:
                break
            self._give(task, 1, waiting)
            has_given = True
        return has_given

    def _give(self, trials: Sequence[Trial], attempt: int, waiting: _Waiting) -> None:
        text = self._results.setup.text
        if self._expected is None:
            self._expected = identity(text)
        try:
            future = self._executor.submit(
                run_trials, text, [one.to_json() for one in trials], self._expected
            )
        except self._losses as error:
            raise ExperimentError(
                "A worker process died, and the executor begins no other.",
                remedy="All trials that ended are kept: repeat the command to go on.",
            ) from error
        waiting[future] = (trials, attempt)

    def _collect(
        self, future: Future[list[TrialResult]], waiting: _Waiting, progress: Progress
    ) -> None:
        """Keep the results of a task, or submit its trials again.

        Raises:
            ExperimentError: The trials were submitted too often.
        """
        trials, attempt = waiting.pop(future)
        is_alone = trials[0] in self._lost
        try:
            results = future.result()
        except self._losses as error:
            if not is_alone:
                self._lost.extend(trials)
                progress.repeated += len(trials)
                return
            died = self._died_again(trials[0], error)
            if died is None:
                return
            results = [died]
        except (WorkerMismatchError, CancelledError) as error:
            reason = str(error) or "A worker was lost."
            if reason not in progress.refused:
                progress.refused.append(reason)
            if attempt >= _ATTEMPTS:
                raise ExperimentError(
                    f"Trial {trials[0].hash} was given away {attempt} times: {reason}",
                    remedy="All trials that ended are kept: repeat the command when "
                    "the workers are in order.",
                ) from error
            progress.repeated += len(trials)
            self._sleep(0.1 * attempt)  # a cluster needs a moment to notice its loss
            self._give(trials, attempt + 1, waiting)
            return
        else:
            self._has_one_ended, self._deaths = True, 0
            self._longest = max(result.seconds for result in results)
        if is_alone:
            self._lost.remove(trials[0])
        ended = list(zip(trials, results, strict=True))
        for is_new, result in zip(self._results.add_all(ended), results, strict=True):
            progress.ended += is_new
            progress.failed += is_new and result.state == "failed"
            self._watch(progress)

    def _died_again(self, trial: Trial, error: BaseException) -> TrialResult | None:
        """Return the failure of a lost trial whose process has died again.

        Until a trial has ended, the cause may be the machine. The trial then waits
        behind the other lost ones, and the method returns None.

        Raises:
            ExperimentError: Too many processes have died in a row.
        """
        self._deaths += 1
        if self._deaths >= _DEATHS or (not self._has_one_ended and len(self._lost) < 2):
            raise ExperimentError(
                f"Worker processes die again and again, last with trial {trial.hash}.",
                remedy="All trials that ended are kept: repeat the command to go on. "
                "The machine may be short of memory; try fewer --workers. A program of "
                'your own needs `if __name__ == "__main__":`.',
            ) from error
        if not self._has_one_ended:
            self._lost.append(self._lost.pop(0))
            return None
        reason = "Its process died, and once more when it was repeated alone."
        return TrialResult(trial.hash, "failed", reason, {}, 0.0, "")

    def _note_refusals(self, progress: Progress) -> None:
        """Report the workers that the executor has refused since the last report."""
        found = refusals(self._executor).values()
        new = [reason for reason in found if reason not in progress.refused]
        if new:
            progress.refused.extend(new)
            self._watch(progress)

    def _let_run_end(self, waiting: _Waiting, progress: Progress) -> None:
        """Wait for the running trials and keep them; cancel the others."""
        for future in list(waiting):
            if future.cancel():
                del waiting[future]
        for future in wait(waiting, timeout=60.0).done:
            self._collect(future, waiting, progress)
