"""A real station in a process of its own, as a user starts it."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from tests.stopwatch import Stopwatch
from tests.waiting import wait_until

ROOT = Path(__file__).parents[2]
PATIENCE = 90.0
"""How long a loaded machine may take to start a station [s]."""


class StationProcess:
    """Runs `station run` with free ports; what it prints goes into files.

    Args:
        folder: Where its files go, the runtime file among them.
        arguments: More arguments.
        root: The checkout that runs.
        environment: More variables for its environment.
    """

    def __init__(
        self,
        folder: Path,
        *arguments: str,
        root: Path = ROOT,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self._out, self._err = folder / "stdout", folder / "stderr"
        self.environment = {
            **{k: v for k, v in os.environ.items() if not k.startswith("STATION_")},
            "XDG_RUNTIME_DIR": str(folder),
            **(environment or {}),
        }
        self._python, self._root = sys.executable, root
        command = [self._python, "-m", "station", "run", "--json"]
        ports = ["--port", "0", "--ui-port", "0"]
        with self._out.open("w") as out, self._err.open("w") as err:
            self.process = subprocess.Popen(
                [*command, *ports, *arguments],
                cwd=root,
                env=self.environment,
                stdout=out,
                stderr=err,
            )

    @property
    def runtime_folder(self) -> Path:
        """Where its runtime files are."""
        return Path(self.environment["XDG_RUNTIME_DIR"]) / "station"

    @property
    def errors(self) -> str:
        """Return what it has written to stderr."""
        return self._err.read_text()

    def told(self, number: int) -> dict[str, str]:
        """Wait for the line `number`, from 0, and return what it says."""

        def lines():
            return self._out.read_text().splitlines(keepends=True)

        self._wait_for(lambda: len(lines()) > number, "the station does not start")
        line = lines()[number]
        assert line.endswith("\n")
        return json.loads(line)

    def access(self) -> dict[str, str]:
        """Wait for the API and return what the runtime file says."""
        return json.loads(Path(self.told(0)["runtime_file"]).read_text())

    def children(self) -> list[int]:
        """Return the processes it has started."""
        pid = self.process.pid
        text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
        return [int(child) for child in text.split()]

    def child(self, part: str) -> int:
        """Wait for the child whose command line has the argument or module `part`.

        Args:
            part: `ui` for the dashboard, `watchdog` for the watchdog.
        """

        def found():
            for pid in self.children():
                # It may have ended since it was listed.
                with suppress(FileNotFoundError, ProcessLookupError):
                    words = Path(f"/proc/{pid}/cmdline").read_text().split("\0")
                    if part in words or f"station.app.{part}" in words:
                        return pid
            return None

        return self._wait_for(found, f"there is no {part}")

    def _wait_for(self, holds, otherwise):
        """Wait until something holds; fail when it ends before, or it takes long."""

        def answer():
            found = holds()
            assert found or self.process.poll() is None, self.errors
            return found

        found = wait_until(answer, PATIENCE)
        assert found, otherwise
        return found

    def end(self, number: signal.Signals) -> float:
        """Send a signal and wait; return how long that takes on a free machine [s]."""
        with Stopwatch(self.process.pid) as watch:
            self.process.send_signal(number)
            self.process.wait(PATIENCE)
        return watch.seconds

    def clean_up(self) -> None:
        """End whatever is left of it."""
        left = self.children() if self.process.poll() is None else []
        if self.process.poll() is None:
            self.end(signal.SIGKILL)
        for pid in left:
            if is_alive(pid):
                os.killpg(pid, signal.SIGKILL)

    def command(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run another command line in the same environment."""
        return subprocess.run(
            [self._python, "-m", "station", *arguments],
            cwd=self._root,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )


def is_alive(pid: int) -> bool:
    """Return whether a process exists and has not ended."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def wait_for_end(pid: int, timeout: float) -> bool:
    """Return whether a process ends within `timeout` [s]."""
    return wait_until(lambda: not is_alive(pid), timeout)
