"""Build the extensions beside a station that runs interpreted, for its next start."""

from collections.abc import Callable

from station import compiled
from station.core.loop.scheduling import ordinary_priority


class ExtensionsBuild:
    """Has the extensions built when none fit and this machine has what it takes.

    The process that builds runs in idle time alone, so that the control loop has the
    processor before it, and outlives the station, so that a short run is enough.

    Args:
        warn: Takes a line about something that is not as it should be.
    """

    def __init__(self, warn: Callable[[str], None]) -> None:
        self._warn = warn
        self._is_started = False

    def start(self) -> str:
        """Start to build if that is needed; return what runs, and why."""
        if compiled.needs_building():
            try:
                # The compiler must not inherit the priority of the control thread's
                # helpers.
                with ordinary_priority():
                    compiled.build_in_background()
            except OSError as error:
                self._warn(f"The extensions cannot be built: {error}.")
            else:
                self._is_started = True
        return compiled.present_status().text()

    def is_settled(self) -> bool:
        """Return whether there is nothing to wait for; warn when the build failed."""
        if not self._is_started:
            return True
        if failure := compiled.find_failure():
            self._warn(f"The extensions could not be built: {failure}")
            return True
        return not compiled.is_being_built()
