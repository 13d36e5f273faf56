"""Start the parts of a station in order, watch them, stop them in reverse order.

The stop has these steps: hold the robot, ask the dashboard to end, close the streams,
wait for the dashboard, end the control thread, end the watchdog.
"""

import contextlib
import hashlib
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from station import compiled
from station.api.agents import AgentPolicy
from station.api.app import Kept, create_app
from station.api.auth import Authenticator
from station.api.cameras import Cameras
from station.api.server import ApiServer
from station.app.addresses import Announcement, check_exposure, host_names
from station.app.composition import ROBOT_NAMESPACE, compose
from station.app.journal import Journal
from station.app.recording_start import make_ports, make_recorder
from station.app.restart_limit import RestartLimit
from station.app.shutdown_signals import ShutdownSignals
from station.app.station_watchdog import StationWatchdog
from station.app.twin import run_model
from station.app.ui_process import (
    AdoptedProcess,
    UiOptions,
    UiProcess,
    find_orphan,
    free_port,
)
from station.config import StationConfig
from station.core.control.switching import SwitchRequest
from station.core.errors import StationError
from station.core.facade.station import Station
from station.core.loop.stop_latch import StopState
from station.core.scheduling import ordinary_priority, realtime_interpreter
from station.local.descriptors import open_more_files, shortage
from station.local.private_files import process_start
from station.local.station_locator import RunningStation, write_runtime_file
from station.local.tls import TlsFiles
from station.rehearsal.certificates import Tolerances
from station.rehearsal.envelope import Envelope
from station.rehearsal.rehearsals import Policy, Rules
from station.reports import LoopState
from station.trials.background_experiments import (
    BackgroundExperiments,
    spare_processors,
)
from station.trials.trial import Setup
from station.web.host_policy import HostPolicy

if TYPE_CHECKING:
    from station.api.tool_port import ToolPort
    from station.records.recorder import Recorder


class ExtensionsBuild:
    """Builds the compiled extensions if none fit and this machine has a compiler.

    The building process runs in idle time only, so that it does not delay the control
    loop. It outlives the station, so that even a short run of the station starts a
    complete build.

    Args:
        warn: Called with a line about a problem.
    """

    def __init__(self, warn: Callable[[str], None]) -> None:
        self._warn = warn
        self._is_started = False

    def start(self) -> str:
        """Start a build if it is needed; return what runs now, and the reason."""
        if compiled.needs_building():
            try:
                with ordinary_priority():
                    compiled.build_in_background()
            except OSError as error:
                self._warn(f"The extensions cannot be built: {error}.")
            else:
                self._is_started = True
        return compiled.present_status().text()

    def is_settled(self) -> bool:
        """Return whether no build is under way; warn if the build failed."""
        if not self._is_started:
            return True
        if failure := compiled.find_failure():
            self._warn(f"The extensions could not be built: {failure}")
            return True
        return not compiled.is_being_built()


READY_TIMEOUT = 2.0
"""Longest wait for the first cycles [s]."""
HOLD_TIMEOUT = 0.3
"""Longest wait for the cycle that stops the controllers [s]."""
SERVER_TIMEOUT = 1.2
"""Longest wait for streams to close and requests to end [s]."""
UI_TIMEOUT = 0.5
"""Longest wait for the dashboard after the server has stopped [s]."""
LOOP_TIMEOUT = 0.4
"""Longest wait for the control thread [s]; all waits together are below 3 s."""
WATCH_PERIOD = 0.2
"""Time between two checks whether the parts of the station run [s]."""


class StationRun:
    """A station with its server and dashboard, from start to end, in the main thread.

    Args:
        config: The configuration.
        tell: Called with the announcement when the API answers.
        tell_dashboard: Called with the announcement when the dashboard answers.
        warn: Called with a line about a problem.
    """

    def __init__(
        self,
        config: StationConfig,
        *,
        tell: Callable[[Announcement], None],
        tell_dashboard: Callable[[Announcement], None],
        warn: Callable[[str], None],
    ) -> None:
        self._config = config
        self._tell = tell
        self._tell_dashboard = tell_dashboard
        self._warn = warn
        self._ui: UiProcess | None = None
        self._watchdog = StationWatchdog(config, warn)
        self._extensions = ExtensionsBuild(warn)
        self._recorder: Recorder | None = None

    def run(self) -> None:
        """Run until SIGINT, SIGTERM or SIGHUP.

        Raises:
            StationError: The station cannot start as configured, or does not stop in
                time.
            EndedByWatchdogError: The watchdog has ended the station.
        """
        try:
            self._run()
        except StationError as error:
            self._watchdog.check_end(error)
            raise
        self._watchdog.check_end()

    def _run(self) -> None:
        with (
            ShutdownSignals(self._end_at_once) as signals,
            contextlib.suppress(KeyboardInterrupt),
            ExitStack() as stack,
        ):
            stack.callback(self._watchdog.finish)
            check_exposure(self._config.api.host, self._config.api.token)
            tls = self._tls()
            if tls is not None:
                tls.context()  # report unusable files before all else
            authenticator = Authenticator(self._config.api.token)
            self._watchdog.start(authenticator)
            station = self._start_loop(stack)
            announcement = self._start_network(stack, station, authenticator)
            # Hold the robot before all other steps of the stop; the stack has a later
            # hold, too.
            stack.callback(_hold, station)
            # The start of the server holds the interpreter, so earlier statistics are
            # not those of the loop.
            station.reset_statistics()
            stack.callback(self._watchdog.expect_end)
            self._watchdog.guard(station)
            self._watch(station, announcement, signals)

    def _start_loop(self, stack: ExitStack) -> Station:
        announce = self._watchdog.announce
        composition = compose(
            self._config, heartbeat=self._watchdog.heartbeat, announce=announce
        )
        station = composition.station
        for warning in composition.warnings():
            self._warn(warning)
        stack.enter_context(realtime_interpreter())
        self._recorder = make_recorder(station, self._config, self._warn)
        if self._recorder is not None:
            stack.callback(self._recorder.close)
            self._recorder.start_thread()
        stack.callback(station.loop.hw.close)
        stack.callback(station.loop.stop, LOOP_TIMEOUT)
        stack.callback(_hold, station)
        station.loop.start()
        start, warnings = composition.sort_starts(self._config.start)
        for warning in warnings:
            self._warn(warning)
        if start:
            announce(f"Starting the controllers {', '.join(start)}")
            station.switch_controllers(SwitchRequest(start=start))
        if self._config.fci.enabled:
            # Imported here, because it loads the Franka's modules, and most stations do
            # not need it.
            from station.app.fci_beside import FciBeside

            fci = self._config.fci
            stack.enter_context(
                FciBeside(station, fci.host, self._warn, fci.version, fci.desk)
            )
        announce("Waiting for the first cycles")
        clock = station.loop.clock
        deadline = clock.now() + READY_TIMEOUT
        while station.ready() and clock.now() < deadline:
            clock.sleep_until(clock.now() + 0.005)
        return station

    def _start_network(
        self, stack: ExitStack, station: Station, authenticator: Authenticator
    ) -> Announcement:
        self._watchdog.announce("Starting the server and the dashboard")
        open_more_files()
        few = shortage()
        if few is not None:
            self._warn(few)
        api, ui, tls = self._config.api, self._config.ui, self._tls()
        # Use the robot's own parameters, which have the pose of its base.
        robot = station.parameters.get(ROBOT_NAMESPACE)
        placed = robot if isinstance(robot, dict) else {}
        orphan = self._find_dashboard(placed)
        ui_port = orphan.port if orphan else 0
        if ui.enabled and not orphan:
            ui_port = free_port(api.host, ui.port)
        journal = stack.enter_context(Journal(station, self._warn))
        authenticator.named = journal.named_tokens()
        experiments = stack.enter_context(closing(self._background_experiments()))
        policy = HostPolicy(host_names(api.host), api.allowed_origins)

        def assignment() -> dict[str, object]:
            robots, viewer = _drawn_robots(placed), authenticator.viewer_token
            return {"url": server.url, "token": viewer, "robots": robots}

        cameras = Cameras(self._config.cameras, assignment)
        app = create_app(
            station,
            authenticator,
            policy,
            dashboard_url=lambda: _dashboard_url(server.url, ui_port),
            kept=Kept(journal.log, self._recorder, experiments),
            agents=AgentPolicy(
                self._config.agents.approval == "always", self._config.agents.wait
            ),
            cameras=stack.enter_context(closing(cameras)),
        )
        app.state.services.rehearsals.adopt(
            _rules_of(self._config), partial(run_model, self._config)
        )
        journal.start(app)
        ports = make_ports(app, station, self._config, policy)
        server = ApiServer(app, api.host, api.port, tls, ports)
        stack.callback(self._finish_ui)
        stack.callback(server.stop, SERVER_TIMEOUT)
        server.start()
        self._name_free_ports(ports)
        token = authenticator.operator_token
        pid = os.getpid()
        running = RunningStation(
            url=server.url,
            token=token,
            viewer_token=authenticator.viewer_token,
            ui_url=_dashboard_url(server.url, ui_port) or "",
            boot_id=station.boot_id,
            pid=pid,
            started=process_start(pid),
            watchdog_url=self._watchdog.url,
            certificate="" if tls is None else str(tls.certificate),
        )
        # Write the file before the dashboard starts, which reads the certificate's path
        # from it.
        path = write_runtime_file(running)
        stack.callback(path.unlink, missing_ok=True)
        if ui.enabled:
            viewer = authenticator.viewer_token
            options = self._ui_options(placed, server.url, token, viewer, ui_port)
            self._ui = UiProcess(options, adopted=orphan)
            stack.callback(self._terminate_ui)
            self._ui.start()
        return Announcement(
            running.url,
            running.ui_url,
            token,
            str(path),
            scheduler=station.loop.report().scheduler,
            kernel=self._extensions.start(),
            robot=station.status().robot_label,
        )

    def _find_dashboard(self, robot: Mapping[str, object]) -> AdoptedProcess | None:
        """Return the dashboard of an earlier station with the same options."""
        api, ui = self._config.api, self._config.ui
        options = self._ui_options(robot, "", "", "", ui.port)
        return find_orphan(api.host, ui.port, options.shown()) if ui.enabled else None

    def _name_free_ports(self, ports: "Sequence[ToolPort[Any]]") -> None:
        """Warn at which port a tool is served if the configuration leaves it open."""
        configured = (self._config.foxglove, self._config.rosbridge)
        asked = [one.port for one in configured if one.enabled]
        for port, number in zip(ports, asked, strict=True):
            if number == 0:
                self._warn(f"{port.tool} is served at port {port.port}.")

    def _background_experiments(self) -> BackgroundExperiments:
        return BackgroundExperiments(Setup.of(self._config), workers=spare_processors())

    def _ui_options(
        self,
        robot: Mapping[str, object],
        api_url: str,
        token: str,
        viewer_token: str,
        port: int,
    ) -> UiOptions:
        first, *beside = _drawn_robots(robot)
        return UiOptions(
            api_url,
            token,
            self._config.api.host,
            port,
            robot_description=first[0],
            arm_id=first[1],
            base=first[2],
            base_moves=robot.get("base", "fixed") != "fixed",
            beside=tuple(beside),
            watchdog_url=self._watchdog.url,
            reconnect_window=self._config.ui.reconnect_window,
            certificate=_fingerprint(self._tls()),
            viewer_token=viewer_token,
        )

    def _tls(self) -> TlsFiles | None:
        """Return certificate and key, with absolute paths; None without TLS."""
        tls = self._config.api.tls
        if tls.certificate is None or tls.key is None:
            return None
        return TlsFiles(Path(tls.certificate).absolute(), Path(tls.key).absolute())

    def _watch(
        self, station: Station, announcement: Announcement, signals: ShutdownSignals
    ) -> None:
        """Watch the parts of the station until a signal comes."""
        self._tell(announcement)
        if not announcement.scheduler.startswith("SCHED_FIFO"):
            self._warn(
                f"The control thread runs with {announcement.scheduler}: cycles may "
                "be late when the machine is busy. `ulimit -r 50` or CAP_SYS_NICE "
                "allows SCHED_FIFO."
            )
        watches = [
            self._watch_loop(station),
            self._watch_ui(announcement),
            self._extensions.is_settled,
        ]
        while not signals.wait(WATCH_PERIOD):
            self._watchdog.look(station)
            watches = [watch for watch in watches if not watch()]

    def _watch_loop(self, station: Station) -> Callable[[], bool]:
        def watch() -> bool:
            if station.loop.state is not LoopState.FAILED:
                return False
            self._warn(f"{station.ready()} The API still answers: GET /api/v1/loop.")
            return True

        return watch

    def _watch_ui(self, announcement: Announcement) -> Callable[[], bool]:
        ui = self._ui
        is_announced = False
        limit = RestartLimit()

        def watch() -> bool:
            nonlocal is_announced
            if ui is None:
                return True
            if not is_announced and ui.answers():
                is_announced = True
                self._tell_dashboard(announcement)
            code = ui.exit_code()
            if code is None:
                return False
            news = f"The dashboard ended (exit code {code})"
            # A dashboard that ends without an error was ended on purpose, e.g. with
            # `kill`.
            if code != 0 and limit.allows_another():
                self._warn(f"{news}; it is started again at the same address.")
                ui.start_again()
                return False
            self._warn(
                f"{news}; the station runs on. Start it again: station ui --connect "
                f"{announcement.api_url}"
            )
            return True

        return watch

    def _terminate_ui(self) -> None:
        if self._ui is not None and not self._watchdog.heartbeat.is_ended_by_watchdog:
            self._ui.terminate()

    def _finish_ui(self) -> None:
        # When the watchdog ends the station, the dashboard waits for the next station,
        # as after a crash.
        if self._ui is not None and not self._watchdog.heartbeat.is_ended_by_watchdog:
            self._ui.finish(UI_TIMEOUT)

    def _end_at_once(self) -> None:
        if self._ui is not None:
            self._ui.kill()


def _rules_of(config: StationConfig) -> Rules:
    """Return the rules of rehearsals in a configuration."""
    section, bounds = config.rehearsal, config.agents.envelope
    return Rules(
        operator=Policy(section.operator),
        agent=Policy(section.agent),
        envelope=Envelope(**dict(bounds)),
        tolerances=Tolerances(section.pose_tolerance, section.tube),
    )


def _hold(station: Station) -> None:
    """Stop all controllers, and wait for the cycle that stops them; the robot holds."""
    loop = station.loop
    if loop.stop_latch.state is not StopState.STOPPED:
        station.stop("the station ends")
    deadline = loop.clock.now() + HOLD_TIMEOUT
    while (
        loop.stop_latch.pending
        and loop.state is LoopState.RUNNING
        and loop.clock.now() < deadline
    ):
        loop.clock.sleep_until(loop.clock.now() + 0.002)


def _dashboard_url(api_url: str, port: int) -> str | None:
    """Return the URL of a dashboard at the API's host; None without a dashboard."""
    # The dashboard speaks plain HTTP, even if the API speaks HTTPS.
    host = api_url.removeprefix("https:").removeprefix("http:").rpartition(":")[0]
    return f"http:{host}:{port}" if port else None


def _fingerprint(tls: TlsFiles | None) -> str:
    """Return the fingerprint of a certificate; empty without TLS."""
    if tls is None:
        return ""
    return hashlib.sha256(tls.certificate.read_bytes()).hexdigest()


def _drawn_robots(
    robot: Mapping[str, object],
) -> list[tuple[str, str, tuple[float, ...]]]:
    """Return description, prefix and base of each robot to draw, one at least.

    A combined robot has a block of parameters for each of its parts.
    """
    names = robot.get("robot_hardware", ())
    parts = [robot.get(str(name)) for name in names] if isinstance(names, list) else []
    blocks = [part for part in parts if isinstance(part, Mapping)] or [robot]
    return [
        (
            str(block.get("robot_description", "")),
            str(block.get("arm_id", "panda")),
            _floats(block.get("base_xyz")) + _floats(block.get("base_rpy")),
        )
        for block in blocks
    ]


def _floats(value: object) -> tuple[float, ...]:
    """Return three numbers that the robot has checked; zeros without numbers."""
    return tuple(map(float, value)) if isinstance(value, list) else (0.0,) * 3
