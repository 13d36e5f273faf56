"""Run experiments for a station, one at a time in a separate process."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from station.core.errors import StationError
from station.core.scheduling import ordinary_priority
from station.trials.errors import (
    ExperimentError,
    ExperimentRunningError,
    TooManyExperimentsError,
)
from station.trials.results import (
    Results,
    default_folder,
    file_of,
    is_written,
    name_of_now,
    names,
)
from station.trials.trial import Setup
from station.wire.experiments import ExperimentRequest

_BEGIN_TIMEOUT = 60.0
"""Longest wait until a process has checked its experiment [s]."""
_END_TIMEOUT = 1.0
"""Longest wait for a process that was asked to end [s]."""
MOST_TRIALS = 10_000
"""Most trials of an experiment that a station runs beside its robot."""
MOST_EXPERIMENTS = 500
"""Most experiments on disk; a station with more starts no other one."""
RUNNING = "running"
_COMMAND = (sys.executable, "-m", "station.experiments")


class ExperimentProcess:
    """A process that has checked an experiment and begun to run it.

    The process reads its experiment from a pipe. It ends at once when the pipe closes,
    which also happens when this process is killed.

    Args:
        command: The program and its arguments.
        order: Request, setup and gains of the experiment.

    Raises:
        StationError: The process refuses the experiment.
        ExperimentError: The process cannot be started, or ended before it began.
    """

    def __init__(self, command: Sequence[str], order: Mapping[str, object]) -> None:
        in_read, in_write = os.pipe()
        out_read, out_write = os.pipe()
        self._is_killed = False
        self._orders = os.fdopen(in_write, "w", encoding="utf-8")
        self._told = os.fdopen(out_read, encoding="utf-8")
        try:
            with ordinary_priority():
                self._process = subprocess.Popen(
                    command,
                    stdin=in_read,
                    stdout=out_write,
                    # Ctrl-C in the station's terminal must not reach the experiment.
                    start_new_session=True,
                )
        except OSError as error:
            self._orders.close()
            self._told.close()
            raise ExperimentError(
                f"No process for the experiment can be started: {error}."
            ) from error
        finally:
            os.close(in_read)
            os.close(out_write)
        try:
            self._begin(order)
        except BaseException:
            self.end()
            self._told.close()
            raise

    def _begin(self, order: Mapping[str, object]) -> None:
        """Send the order to the process, and wait until the process has checked it.

        Raises:
            StationError: The process refuses the experiment.
            ExperimentError: The process ended before it began.
        """
        # Reading a pipe has no time limit, so end the process after one, which closes
        # the pipe.
        guard = threading.Timer(_BEGIN_TIMEOUT, self._process.kill)
        guard.daemon = True
        guard.start()
        try:
            self._orders.write(f"{json.dumps(order)}\n")
            self._orders.flush()
            line = self._told.readline()
        except BrokenPipeError:
            line = ""
        finally:
            guard.cancel()
        if not line:
            raise ExperimentError(
                "The process of the experiment ended before it began: "
                f"{self.how_it_ended()}",
                remedy="The station's log says more. A simulation needs the extra "
                "`sim`, a search the extra `experiments`.",
            )
        _check(json.loads(line))

    def lines(self) -> Iterator[dict[str, Any]]:
        """Return the lines of the process as it prints them, until it ends."""
        with self._told:
            for line in self._told:
                if line.endswith("\n"):  # a killed process may cut it off
                    yield json.loads(line)

    def interrupt(self) -> None:
        """Ask the process to end its experiment; it may complete its running trials."""
        self._process.send_signal(signal.SIGINT)

    def end(self) -> None:
        """End the process and its workers now; ended trials are kept."""
        with contextlib.suppress(BrokenPipeError):  # the process may have ended already
            # The workers end when the pipe of orders closes.
            self._orders.close()
        try:
            self._process.wait(_END_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._is_killed = True
            self._process.kill()
            self._process.wait(_END_TIMEOUT)

    def how_it_ended(self) -> str:
        """Return a sentence about the end of the process, which has closed its output.

        A process that still runs is killed.
        """
        self.end()
        code = self._process.returncode
        if self._is_killed:
            return "it said no more but did not end, so the station killed it."
        if code < 0:
            return f"it was killed by {signal.Signals(-code).name}."
        return f"exit code {code}."


def _check(begun: Mapping[str, Any]) -> None:
    """Raise the error that a process reports, if any.

    Raises:
        StationError: The process refuses the experiment.
    """
    refused = begun.get("refused")
    if refused is None:
        return
    kinds: list[type[StationError]] = [StationError]
    for kind in kinds:
        kinds.extend(kind.__subclasses__())
    # Base classes come last, so that of two classes with the same code the base class
    # is raised.
    known = {kind.code: kind for kind in reversed(kinds)}
    found = known.get(refused["code"], ExperimentError)
    raise found(
        refused["message"], remedy=refused["remedy"], details=refused["details"]
    )


@dataclass(frozen=True, slots=True)
class RunState:
    """The progress of the running experiment, or of the last one.

    Attributes:
        name: Its name.
        state: `running`, `done`, `cancelled` or `failed`.
        reason: Reason of its end; empty while it runs, and when it is done.
        ended: Number of trials that have ended.
        total: Largest number of trials that it can have.
        failed: Number of trials of this run that have failed.
        resumed: Number of trials that had ended before this run.
        seconds: Time since it began [s].
    """

    name: str
    state: str
    reason: str = ""
    ended: int = 0
    total: int = 0
    failed: int = 0
    resumed: int = 0
    seconds: float = 0.0


class BackgroundExperiments:
    """Starts, follows and cancels the experiments of a station. Any thread.

    An experiment runs in a process of low priority. The process and its workers end
    with the station, even if the station is killed. Trials that have ended are kept.

    Args:
        setup: The configuration of the station.
        workers: Number of processes that run trials, unless a request names another
            number, >= 1.
        command: The program that runs an experiment.

    Attributes:
        tell: Called at every change of the state, in the thread that follows the
            experiment.
    """

    def __init__(
        self, setup: Setup, workers: int = 1, command: Sequence[str] = _COMMAND
    ) -> None:
        self.tell: Callable[[RunState], None] = lambda _: None
        self._setup = setup
        self._workers = workers
        self._command = list(command)
        self._starting = threading.Lock()
        self._process: ExperimentProcess | None = None
        self._state: RunState | None = None
        self._is_cancelled = False
        self._began = 0.0

    @property
    def state(self) -> RunState | None:
        """Return the progress of the running or last experiment; None before any."""
        state = self._state
        if state is None or state.state != RUNNING:
            return state
        return replace(state, seconds=time.monotonic() - self._began)

    def start(
        self,
        request: ExperimentRequest,
        gains: Mapping[str, Mapping[str, float]],
        loaded: Mapping[str, Mapping[str, object]] | None = None,
    ) -> str:
        """Start an experiment; return its name after the request is checked.

        Args:
            request: Request of the caller.
            gains: The gains in force, by controller and name.
            loaded: Parameters of the controllers that are loaded now, by name; None
                takes those of the configuration.

        Raises:
            ExperimentRunningError: Another experiment runs.
            TooManyExperimentsError: The request has too many trials, or too many
                experiments are kept.
            StationError: A name or value is not allowed; nothing was started.
        """
        if request.trials > MOST_TRIALS:
            raise TooManyExperimentsError(
                f"The experiment would have {request.trials} trials; a station runs "
                f"{MOST_TRIALS} at most.",
                remedy="Run it with the command line, which may use a cluster.",
            )
        # A request must not wait for the start of another one, which may take a minute.
        if not self._starting.acquire(blocking=False):
            raise ExperimentRunningError(
                "Another experiment is being started; a station runs one at a time.",
                remedy="Wait for its end, or cancel it.",
            )
        try:
            return self._start(request, gains, loaded or {})
        finally:
            self._starting.release()

    def _start(
        self,
        request: ExperimentRequest,
        gains: Mapping[str, Mapping[str, float]],
        loaded: Mapping[str, Mapping[str, object]],
    ) -> str:
        name = request.name or name_of_now(request.kind)
        self._check_free(name)
        workers = request.workers or self._workers
        request = request.model_copy(update={"name": name, "workers": workers})
        live = {name: dict(values) for name, values in gains.items()}
        process = ExperimentProcess(
            self._command,
            {
                "request": request.model_dump(mode="json"),
                "setup": self._setup.with_controllers(loaded).text,
                "gains": live if request.is_live else {},
            },
        )
        self._process, self._is_cancelled = process, False
        self._began = time.monotonic()
        state = RunState(name, RUNNING, total=request.trials)
        self._change(state)
        threading.Thread(
            target=self._follow, args=(process, state), name="experiment", daemon=True
        ).start()
        return name

    def cancel(self, name: str) -> None:
        """End the running experiment; it may complete its running trials.

        Raises:
            ExperimentNotFoundError: There is no such experiment.
            ExperimentRunningError: The experiment does not run.
        """
        process = self._process
        if process is None or not self._runs(name):
            Results.open(file_of(name)).close()
            raise ExperimentRunningError(
                f"The experiment '{name}' does not run.", details={"experiment": name}
            )
        # Set the flag before the signal, because the following thread reads it as soon
        # as the process ends.
        self._is_cancelled = True
        process.interrupt()

    def delete(self, name: str) -> None:
        """Delete the file of an experiment.

        Raises:
            ExperimentNotFoundError: There is no such experiment.
            ExperimentRunningError: The experiment runs, in this station or another.
            ExperimentError: The file cannot be deleted.
        """
        # The command line may be writing the file from another process.
        if self._runs(name) or is_written(file_of(name)):
            raise ExperimentRunningError(
                f"The experiment '{name}' runs.", remedy="Cancel it first."
            )
        Results.open(file_of(name)).delete()

    def close(self) -> None:
        """End the process, if one runs; ended trials are kept."""
        if self._process is not None:
            self._process.end()

    def _runs(self, name: str) -> bool:
        state = self._state
        return state is not None and (state.name, state.state) == (name, RUNNING)

    def _check_free(self, name: str) -> None:
        """Refuse to start while another experiment runs, or when too many are kept.

        Raises:
            ExperimentRunningError: Another experiment runs.
            TooManyExperimentsError: Too many experiments are kept.
        """
        state = self._state
        if state is not None and state.state == RUNNING:
            raise ExperimentRunningError(
                f"The experiment '{state.name}' runs; a station runs one at a time.",
                remedy="Wait for its end, or cancel it.",
                details={"experiment": state.name},
            )
        kept = names()
        if len(kept) >= MOST_EXPERIMENTS and name not in kept:
            raise TooManyExperimentsError(
                f"{len(kept)} experiments are kept in {default_folder()}; allowed are "
                f"{MOST_EXPERIMENTS}.",
                remedy="Delete some.",
            )

    def _follow(self, process: ExperimentProcess, state: RunState) -> None:
        """Read the reports of the process until it ends. Its own thread."""
        end = None
        for message in process.lines():
            if "end" in message:
                end = message["end"]
            elif "progress" in message:
                state = replace(state, **message["progress"])
                self._change(state)
        how = process.how_it_ended()
        if end is None:
            end = {
                "state": "cancelled" if self._is_cancelled else "failed",
                "reason": f"Its process ended early: {how} All trials that had ended "
                "are kept; start it again under the same name to go on.",
            }
        seconds = time.monotonic() - self._began
        self._change(replace(state, **end, seconds=seconds))

    def _change(self, state: RunState) -> None:
        self._state = state
        self.tell(state)


def spare_processors() -> int:
    """Return the number of processors for trials: all but one, and at least one."""
    # One processor is left to the control thread.
    return max(1, len(os.sched_getaffinity(0)) - 1)
