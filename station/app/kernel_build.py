"""Build the kernel beside a station that runs interpreted, for its next start."""

import subprocess
import sys
from collections.abc import Callable

from station.core.loop.scheduling import ordinary_priority
from station.kernel import STATUS
from station.kernel.built import (
    find_failure,
    is_being_built,
    needs_building,
    present_status,
)

_TIMEOUT = 30.0
"""How long a loaded machine may take to start the process that builds [s]."""
_COMMAND = (sys.executable, "-m", "station.kernel.build", "--background")


class KernelBuild:
    """Has the kernel built when none fits and this machine has what it takes.

    The process that builds runs in idle time alone, so that the control loop has the
    processor before it, and outlives the station, so that a short run is enough.

    Args:
        warn: Takes a line about something that is not as it should be.
    """

    def __init__(self, warn: Callable[[str], None]) -> None:
        self._warn = warn
        self._is_started = False

    def start(self) -> str:
        """Start to build if that is needed; return which kernel runs, and why."""
        if needs_building(STATUS):
            self._is_started = True
            try:
                with ordinary_priority():
                    subprocess.run(
                        _COMMAND,
                        check=True,
                        timeout=_TIMEOUT,
                        stdin=subprocess.DEVNULL,
                        stdout=subprocess.DEVNULL,
                        stderr=subprocess.DEVNULL,
                    )
            except (OSError, subprocess.SubprocessError) as error:
                self._warn(f"The kernel cannot be built: {error}.")
        return present_status(STATUS).text()

    def is_settled(self) -> bool:
        """Return whether there is nothing to wait for; warn when the build failed."""
        if not self._is_started:
            return True
        if (failure := find_failure()) is not None:
            self._warn(f"The kernel could not be built, see {failure}.")
            return True
        return not is_being_built()
