"""Loading controllers in threads of their own, beside everything else.

Importing a plug-in, its constructor and its `init` are foreign code: they may take
seconds, hang, or call the manager. They run in a thread of their own and under no lock.
The caller waits for the controller up to a deadline and can cancel the loading; nothing
else waits.
"""

import threading
from collections.abc import Callable

from station.core.control.controller import ControllerState
from station.core.control.controller_status import ControllerStatus
from station.core.control.loaded_controller import LoadedController
from station.core.errors import ControllerLoadError
from station.core.numerics.durations import DurationRing

LOAD_TIMEOUT = 60.0
"""Default of the wall time in which a controller must be loaded [s]."""


class Loading:
    """A controller that is being loaded.

    Args:
        name: Name of the controller.
        build: Imports, creates and initialises the controller.

    Attributes:
        name: As given.
    """

    def __init__(self, name: str, build: Callable[[], LoadedController]) -> None:
        self.name = name
        self._build = build
        self._done = threading.Event()
        self._loaded: list[LoadedController] = []
        self._error: BaseException | None = None
        self._is_cancelled = False

    def load(self, timeout: float) -> LoadedController:
        """Load the controller in a thread of its own.

        Args:
            timeout: How long to wait for it [s wall time], > 0.

        Raises:
            ControllerLoadError: The loading took too long, or was cancelled. Its thread
                cannot be ended; a controller that it makes later is thrown away.
            BaseException: Whatever building it raised.
        """
        # A daemon thread: an import that never returns must not keep the process alive.
        thread = threading.Thread(
            target=self._run, name=f"load {self.name}", daemon=True
        )
        thread.start()
        if not self._done.wait(timeout):
            raise ControllerLoadError(
                f"Controller '{self.name}' was not loaded within {timeout:g} s: its "
                "import, its constructor or its init does not return.",
                remedy="Correct the controller. The thread that loads it goes on until "
                "it returns or the station ends; its result is thrown away.",
                details={"controller": self.name, "timeout": timeout},
            )
        if self._is_cancelled:
            raise ControllerLoadError(
                f"The loading of controller '{self.name}' was cancelled.",
                remedy="Load it again if you still want it.",
                details={"controller": self.name},
            )
        thread.join()  # it has set the event and ends
        if self._error is not None:
            # The error is not kept: its traceback would keep the controller alive.
            error, self._error = self._error, None
            try:
                raise error
            finally:
                del error
        return self._loaded.pop()

    def cancel(self) -> None:
        """Let the waiting caller go on without the controller."""
        self._is_cancelled = True
        # The event comes last: `load` looks at the flag when it wakes up.
        self._done.set()

    def status(self) -> ControllerStatus:
        """Return the status of the controller."""
        return ControllerStatus(
            self.name,
            "",
            ControllerState.LOADING,
            (),
            None,
            None,
            (),
            DurationRing(1).percentiles(),
        )

    def _run(self) -> None:
        try:
            self._loaded.append(self._build())
        except BaseException as error:  # noqa: BLE001 - handed to the caller
            self._error = error
        self._done.set()
