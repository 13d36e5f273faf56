"""Run one experiment for a station, in a process of its own at low priority.

The first line of the standard input is the experiment, as JSON. The process ends at
once when its input ends, because the station has ended then. It reports its progress in
lines of JSON. SIGINT ends the experiment after its running trials.
"""

import json
import os
import signal
import sys
import threading
import time
import traceback
from typing import IO

from station.core.errors import StationError
from station.experiments.experiment import carry_out, prepare
from station.experiments.pools import NICENESS, be_polite, kept_world, make_pool
from station.experiments.runner import Progress
from station.trials.analysis import best_of, first_of
from station.trials.results import Results, file_of
from station.trials.trial import Setup
from station.wire.experiments import ExperimentRequest

_PERIOD = 0.5
"""Shortest time between two lines about the progress [s]."""
_GONE = 3
"""Exit code when the station has ended."""


class Reporter:
    """Reports the progress of the experiment, and records its first and best trial.

    Args:
        results: The experiment.
        output: Receives the lines of the report.
    """

    def __init__(self, results: Results, output: IO[str]) -> None:
        self._results = results
        self._output = output
        self._next = 0.0
        self._recorded: set[str] = set()

    def watch(self, progress: Progress) -> None:
        """Report the progress, at most every `_PERIOD`."""
        if time.monotonic() >= self._next:
            self.tell(progress)
            self.record()
            self._next = time.monotonic() + _PERIOD

    def tell(self, progress: Progress) -> None:
        """Report the progress."""
        tell(
            self._output,
            progress={
                "ended": progress.ended,
                "total": progress.total,
                "failed": progress.failed,
                "resumed": progress.resumed,
                "reason": " ".join(progress.refused),
            },
        )

    def record(self) -> None:
        """Record every cycle of the first trial and of the best one so far."""
        wanted = [first_of(self._results), best_of(self._results)]
        new = [
            row.result.hash
            for row in wanted
            if row is not None and row.result.hash not in self._recorded
        ]
        if not new:
            return
        world = kept_world(self._results.setup)
        for name in new:
            _, trace = world.record(self._results.trial(name))
            self._recorded.add(name)
            if trace is not None:
                self._results.keep_recording(name, trace)
        # Drop the recordings of trials that are no longer the best.
        self._results.drop_recordings({row.result.hash for row in wanted if row})


def main() -> int:
    """Run the experiment that the standard input describes; return the exit code."""
    be_polite(NICENESS)
    # The station cancels by SIGINT, which a program in the background would ignore.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    # The output of libraries must not mix with the lines of the report.
    output = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    order = json.loads(sys.stdin.readline())
    threading.Thread(target=_end_with_station, daemon=True).start()
    request = ExperimentRequest.model_validate(order["request"])
    try:
        experiment = prepare(Setup(order["setup"]), request, order["gains"])
        results = Results.create(
            file_of(request.name), experiment.kind, experiment.setup, experiment.plan
        )
    except StationError as error:
        tell(output, refused=_plain(error))
        return 1
    with results:
        tell(output, begun=request.name)
        reporter = Reporter(results, output)
        state, reason = "done", ""
        try:
            with make_pool(request.workers) as executor:
                progress = carry_out(experiment, results, executor, reporter.watch)
            reporter.record()
            reporter.tell(progress)
            state, reason = results.outcome()
        except KeyboardInterrupt:
            state = "cancelled"
        except StationError as error:
            state, reason = "failed", f"{error.message} {error.remedy}".strip()
        except Exception as error:  # noqa: BLE001 - the boundary: logged and told
            traceback.print_exc()
            state, reason = "failed", _blame(error)
        tell(output, end={"state": state, "reason": reason})
    return 0


def tell(output: IO[str], **facts: object) -> None:
    """Write one line of JSON."""
    output.write(f"{json.dumps(facts)}\n")
    output.flush()


def _blame(error: Exception) -> str:
    """Return a sentence that names an unexpected error, and where it was raised."""
    raised = traceback.extract_tb(error.__traceback__)[-1]
    return (
        f"{type(error).__name__} in {raised.filename}, line {raised.lineno}: {error}. "
        "The station's log has the traceback."
    )


def _plain(error: StationError) -> dict[str, object]:
    return {
        "code": error.code,
        "message": error.message,
        "remedy": error.remedy,
        "details": json.loads(json.dumps(error.details, default=str)),
    }


def _end_with_station() -> None:
    while sys.stdin.readline():
        pass
    os._exit(_GONE)


if __name__ == "__main__":
    sys.exit(main())
