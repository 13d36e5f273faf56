"""Start a process that runs one experiment, and read its reports."""

import contextlib
import json
import os
import signal
import subprocess
import threading
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from station.core.errors import StationError
from station.core.scheduling import ordinary_priority
from station.trials.errors import ExperimentError

_BEGIN_TIMEOUT = 60.0
"""Longest wait until a process has checked its experiment [s]."""
_END_TIMEOUT = 1.0
"""Longest wait for a process that was asked to end [s]."""


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
