"""Start a station in order, watch it, stop it in reverse order.

Stopping: the robot is held, the dashboard is told to end, streams close, the
dashboard is gone, the control thread ends.
"""

import contextlib
import os
import time
from collections.abc import Callable
from contextlib import ExitStack

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.host_policy import HostPolicy
from station.api.server import ApiServer
from station.app.access import check_exposure, host_names
from station.app.announcement import Announcement
from station.app.composition import compose
from station.app.runtime_file import (
    RunningStation,
    process_start,
    write_runtime_file,
)
from station.app.shutdown_signals import ShutdownSignals
from station.app.ui_process import UiProcess, free_port
from station.config import StationConfig
from station.core.loop_report import LoopState
from station.core.scheduling import realtime_interpreter
from station.core.station import Station
from station.core.switching import SwitchRequest

HOLD_TIMEOUT = 0.3
"""Longest wait for the cycle that stops the controllers [s]."""
SERVER_TIMEOUT = 1.5
"""Longest wait for streams to close and requests to end [s]."""
UI_TIMEOUT = 0.7
"""Longest wait for the dashboard after the server has stopped [s]."""
WATCH_PERIOD = 0.25
"""How often the station looks whether its parts live [s]."""


class RunningApplication:
    """A station with its server and dashboard. For the main thread.

    Args:
        config: The configuration.
        tell: Takes the announcement once everything runs.
        warn: Takes a line about something that is not as it should be.
    """

    def __init__(
        self,
        config: StationConfig,
        *,
        tell: Callable[[Announcement], None],
        warn: Callable[[str], None],
    ) -> None:
        self._config = config
        self._tell = tell
        self._warn = warn
        self._ui: UiProcess | None = None
        self._cleanup = ExitStack()

    def run(self) -> None:
        """Run until SIGINT, SIGTERM or SIGHUP.

        Raises:
            StationError: It cannot start as configured, or not stop in time.
        """
        with ShutdownSignals(self._end_at_once) as signals:
            with contextlib.suppress(KeyboardInterrupt), self._cleanup as stack:
                self._watch(self._start(stack), signals)

    def _start(self, stack: ExitStack) -> Station:
        config = self._config
        host = config.api.host
        check_exposure(host, config.api.token)
        ui_port = free_port(host, config.ui.port) if config.ui.enabled else 0
        composition = compose(config)
        station = composition.station
        for name, error in composition.not_loaded.items():
            self._warn(f"Controller '{name}' is not loaded: {error} {error.remedy}")
        authenticator = Authenticator(config.api.token)
        policy = HostPolicy(host_names(host))
        server = ApiServer(
            create_app(station, authenticator, policy), host, config.api.port
        )
        stack.enter_context(realtime_interpreter())
        stack.callback(station.loop.stop)
        station.loop.start()
        if config.start:
            station.switch_controllers(SwitchRequest(start=config.start))
        ui = UiProcess if config.ui.enabled else None
        if ui is not None:
            stack.callback(self._finish_ui)
        stack.callback(server.stop, SERVER_TIMEOUT)
        server.start()
        if ui is not None:
            self._ui = ui(server.url, authenticator.operator_token, host, ui_port)
            self._ui.start()
            stack.callback(self._ui.terminate)
        stack.callback(_hold, station)
        self._announce(stack, station, server, authenticator, ui_port)
        return station

    def _announce(
        self,
        stack: ExitStack,
        station: Station,
        server: ApiServer,
        authenticator: Authenticator,
        ui_port: int,
    ) -> None:
        ui_url = f"{server.url.rpartition(':')[0]}:{ui_port}" if ui_port else ""
        pid = os.getpid()
        path = write_runtime_file(
            RunningStation(
                url=server.url,
                token=authenticator.operator_token,
                viewer_token=authenticator.viewer_token,
                ui_url=ui_url,
                boot_id=station.boot_id,
                pid=pid,
                started=process_start(pid),
            )
        )
        stack.callback(path.unlink, missing_ok=True)
        scheduler = station.loop_report().scheduler
        if not scheduler.startswith("SCHED_FIFO"):
            self._warn(
                f"The control thread runs with {scheduler}: cycles may be late when "
                "the machine is busy. Allow it with `ulimit -r 50` or CAP_SYS_NICE."
            )
        self._tell(
            Announcement(
                api_url=server.url,
                ui_url=ui_url,
                token=authenticator.operator_token,
                runtime_file=str(path),
                scheduler=scheduler,
            )
        )

    def _watch(self, station: Station, signals: ShutdownSignals) -> None:
        is_ui_gone = has_failed = False
        while not signals.wait(WATCH_PERIOD):
            code = None if self._ui is None else self._ui.exit_code()
            if code is not None and not is_ui_gone:
                is_ui_gone = True
                self._warn(
                    f"The dashboard ended (exit code {code}); the station runs on. "
                    "Start it again with `station ui`."
                )
            if station.loop.state is LoopState.FAILED and not has_failed:
                has_failed = True
                self._warn(station.ready())

    def _finish_ui(self) -> None:
        if self._ui is not None:
            self._ui.finish(UI_TIMEOUT)

    def _end_at_once(self) -> None:
        if self._ui is not None:
            self._ui.kill()


def _hold(station: Station) -> None:
    """Stop all controllers and wait for the cycle that does it; the robot holds."""
    station.stop("the station ends")
    deadline = time.monotonic() + HOLD_TIMEOUT
    while station.loop.stop_latch.pending and time.monotonic() < deadline:
        time.sleep(0.002)
