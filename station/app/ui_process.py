"""The dashboard's process: started by a station, or adopted after a crash."""

import json
import os
import signal
import socket
import subprocess
import sys
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPException
from typing import Protocol

import station
from station.app.orphaned_dashboard import DashboardRecord, claim_orphan, dashboard_path
from station.core.errors import StationError
from station.core.scheduling import ordinary_priority
from station.local.descriptors import wait_until_readable
from station.local.private_files import process_start

ORPHAN_TIME = 1.0
"""Time for a dashboard that does not fit to end before it is killed [s]."""
UNKNOWN_CODE = -1
"""Exit code of an adopted process, because the system reports the true one to its
parent only."""


class PortTakenError(StationError, OSError):
    """The dashboard cannot listen at its port.

    Args:
        host: Host of the port.
        port: Its port.
        cause: Error message of the operating system.
    """

    code = "cannot_listen"

    def __init__(self, host: str, port: int, cause: OSError) -> None:
        super().__init__(
            f"The dashboard cannot listen on {host}:{port}: {cause.strerror or cause}.",
            remedy=f"Choose another port (--ui-port {port + 1}, or 0 for any free "
            "one), end what has it, or run without dashboard: --no-ui.",
            details={"host": host, "port": port},
        )


def free_port(host: str, port: int) -> int:
    """Return a free port: `port`, or any free port if it is 0.

    Raises:
        PortTakenError: `port` is taken, or `host` is not an address of this machine.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise PortTakenError(host, port, error) from error
        return int(probe.getsockname()[1])


VIEWER_VARIABLE = "STATION_VIEWER_TOKEN"
"""Environment variable that passes the viewer's token to a dashboard."""


@dataclass(frozen=True, slots=True)
class UiOptions:
    """The settings that are passed to the dashboard's process.

    Attributes:
        api_url: URL of the station's API.
        token: The operator's token.
        host: Host on which the dashboard listens.
        port: Its port, not 0.
        robot_description: Description of the robot to draw; empty draws no robot.
        arm_id: Prefix of the robot's joints.
        base: Pose of the root link: x, y, z [m], roll, pitch, yaw [rad].
        base_moves: Whether the root link floats or drives, so that `base` is not its
            pose.
        beside: Description, prefix and base of each further robot to draw.
        watchdog_url: URL of the station's watchdog; empty without a watchdog.
        reconnect_window: How long the dashboard waits for another station after a crash
            [s].
        certificate: Hash of the station's certificate, which the dashboard trusts;
            empty without TLS. A station with another certificate needs another
            dashboard.
        viewer_token: The viewer's token, for sessions that outlive a station.
    """

    api_url: str
    token: str
    host: str
    port: int
    robot_description: str = ""
    arm_id: str = "panda"
    base: tuple[float, ...] = (0.0,) * 6
    base_moves: bool = False
    beside: tuple[tuple[str, str, tuple[float, ...]], ...] = ()
    watchdog_url: str = ""
    reconnect_window: float = 60.0
    certificate: str = ""
    viewer_token: str = ""

    def shown(self) -> str:
        """Return, as text, the settings that a dashboard must have to be adopted."""
        first = (self.robot_description, self.arm_id, self.base, self.base_moves)
        drawn = (*first, self.beside)
        options = (self.reconnect_window, self.certificate)
        return f"{station.__version__} {drawn} {options}"

    def command(self) -> list[str]:
        """Return the command line, without the token, which others could read there."""
        return [
            *(sys.executable, "-m", "station", "ui", "--connect", self.api_url),
            *("--host", self.host, "--port", str(self.port)),
            *("--robot-description", self.robot_description),
            *("--base", *(f"{value:.6f}" for value in self.base)),
            *(("--base-moves",) if self.base_moves else ()),
            *("--arm-id", self.arm_id, "--parent-pid", str(os.getpid())),
            *("--beside", json.dumps(self.beside)),
            *("--watchdog", self.watchdog_url),
            *("--reconnect-window", str(self.reconnect_window)),
        ]


class _Process(Protocol):
    """The part of `subprocess.Popen` that an adopted process offers, too."""

    @property
    def pid(self) -> int: ...
    def poll(self) -> int | None: ...
    def wait(self, timeout: float | None = None) -> int: ...


class AdoptedProcess:
    """A process that another program has started, held by a `pidfd`.

    Args:
        pid: Its process number.
        port: The port of the dashboard in it.

    Raises:
        ProcessLookupError: The process has ended.
    """

    def __init__(self, pid: int, port: int) -> None:
        self.pid = pid
        self.port = port
        self._descriptor = os.pidfd_open(pid)

    def poll(self) -> int | None:
        """Return None while the process runs, `UNKNOWN_CODE` afterwards."""
        ended = wait_until_readable([self._descriptor], 0.0)
        return UNKNOWN_CODE if ended else None

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end; return `UNKNOWN_CODE`.

        Raises:
            TimeoutExpired: The process still runs after `timeout` [s].
        """
        if not wait_until_readable([self._descriptor], timeout):
            raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
        return UNKNOWN_CODE


def find_orphan(host: str, port: int, shown: str) -> AdoptedProcess | None:
    """Return a dashboard that a crashed station has left and that fits this station.

    A dashboard that listens at the wanted port but does not fit is ended.

    Args:
        host: Host on which the dashboard must listen.
        port: Its port; 0 accepts any port.
        shown: The text of `UiOptions.shown` that the dashboard must have.

    Raises:
        RuntimeDirectoryError: The runtime directory belongs to another user.
    """
    record = claim_orphan(host, port)
    if record is None:
        return None
    try:
        process = AdoptedProcess(record.pid, record.port)
    except ProcessLookupError:
        return None  # it ended while it was claimed
    if record.shown == shown:
        return process
    os.kill(process.pid, signal.SIGTERM)
    try:
        process.wait(ORPHAN_TIME)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait(ORPHAN_TIME)
    return None


class UiProcess:
    """Runs `station ui` in a session of its own, so that Ctrl-C does not reach it.

    A serving dashboard outlives a crash of this process for a while, so that the next
    station can adopt it. Otherwise it ends by itself.

    Args:
        options: Options of the dashboard. Environment variables pass the tokens.
        command: The command line; None for that of `options`.
        adopted: A running dashboard to adopt; None starts a new one.
    """

    def __init__(
        self,
        options: UiOptions,
        command: list[str] | None = None,
        adopted: AdoptedProcess | None = None,
    ) -> None:
        self._options = options
        self._command = options.command() if command is None else command
        self._process: _Process | None = adopted

    def start(self) -> None:
        """Start the process, or tell a running one its new station, without waiting.

        Raises:
            RuntimeDirectoryError: The runtime directory cannot be used.
        """
        if self._process is None:
            self._process = self._start_process()
        self._record(self._process.pid).write()

    def start_again(self) -> None:
        """Start the process again at the same port, after it has ended.

        Raises:
            RuntimeDirectoryError: The runtime directory cannot be used.
        """
        if self._process is not None:
            dashboard_path(self._process.pid).unlink(missing_ok=True)
        self._process = None
        self.start()

    def _record(self, pid: int) -> DashboardRecord:
        options = self._options
        return DashboardRecord(
            pid=pid,
            started=process_start(pid),
            host=options.host,
            port=options.port,
            shown=options.shown(),
            station_pid=os.getpid(),
            station_started=process_start(os.getpid()),
            api_url=options.api_url,
            token=options.token,
            watchdog_url=options.watchdog_url,
            viewer_token=options.viewer_token,
        )

    def _start_process(self) -> subprocess.Popen[bytes]:
        with ordinary_priority():
            return subprocess.Popen(
                self._command,
                stdin=subprocess.DEVNULL,
                env={
                    **os.environ,
                    "STATION_TOKEN": self._options.token,
                    VIEWER_VARIABLE: self._options.viewer_token,
                },
                start_new_session=True,
            )

    def answers(self) -> bool:
        """Return whether the dashboard already answers requests."""
        host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(
            self._options.host, self._options.host
        )
        connection = HTTPConnection(host, self._options.port, timeout=0.2)
        try:
            connection.request("GET", "/login")
            return connection.getresponse().status < 500
        except (OSError, HTTPException):
            return False
        finally:
            connection.close()

    def exit_code(self) -> int | None:
        """Return the exit code; None while it runs or before it was started.

        It is `UNKNOWN_CODE` for a dashboard that was adopted.
        """
        return None if self._process is None else self._process.poll()

    def terminate(self) -> None:
        """Ask the dashboard to end, without waiting."""
        self._signal(signal.SIGTERM)

    def kill(self) -> None:
        """Kill the dashboard and its child processes, without waiting."""
        self._signal(signal.SIGKILL)

    def finish(self, timeout: float) -> None:
        """Wait until the process has ended; kill it after `timeout` [s]."""
        process = self._process
        if process is None:
            return
        try:
            process.wait(timeout)
        except subprocess.TimeoutExpired:
            self.kill()
            process.wait()
        dashboard_path(process.pid).unlink(missing_ok=True)

    def _signal(self, number: signal.Signals) -> None:
        process = self._process
        if process is not None and process.poll() is None:
            os.killpg(process.pid, number)
