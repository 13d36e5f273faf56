"""The dashboard's process: started with the station, gone with it."""

import os
import signal
import socket
import subprocess
import sys
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPException

from station.core.errors import StationError


class PortTakenError(StationError, OSError):
    """The dashboard cannot listen at its port.

    Args:
        host: Where it was to listen.
        port: Its port.
        cause: What the system said.
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
    """Return a port that can be listened at: `port`, or any when it is 0.

    Raises:
        PortTakenError: `port` is taken, or `host` is not this machine's.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise PortTakenError(host, port, error) from error
        return int(probe.getsockname()[1])


@dataclass(frozen=True, slots=True)
class UiOptions:
    """What the dashboard is told.

    Attributes:
        api_url: The station's API.
        token: The operator's token.
        host: Where the dashboard listens.
        port: Its port, not 0.
        robot_description: The robot to draw; empty draws none.
        arm_id: Prefix of the robot's joints.
        base: Where its root link stands: x, y, z [m], roll, pitch, yaw [rad].
    """

    api_url: str
    token: str
    host: str
    port: int
    robot_description: str = ""
    arm_id: str = "panda"
    base: tuple[float, ...] = (0.0,) * 6

    def command(self) -> list[str]:
        """Return the command line; the token is not in it, others could read it."""
        return [
            *(sys.executable, "-m", "station", "ui", "--connect", self.api_url),
            *("--host", self.host, "--port", str(self.port)),
            *("--robot-description", self.robot_description),
            *("--base", *(f"{value:.6f}" for value in self.base)),
            *("--arm-id", self.arm_id, "--parent-pid", str(os.getpid())),
        ]


class UiProcess:
    """Runs `station ui` in a session of its own, so that Ctrl-C does not reach it.

    The dashboard ends by itself when this process ends, however it ends.

    Args:
        options: What the dashboard is told. The token goes by the environment.
        command: The command line; the options' own when None.
    """

    def __init__(self, options: UiOptions, command: list[str] | None = None) -> None:
        self._options = options
        self._command = options.command() if command is None else command
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start the process; does not wait until the dashboard answers."""
        self._process = subprocess.Popen(
            self._command,
            stdin=subprocess.DEVNULL,
            env={**os.environ, "STATION_TOKEN": self._options.token},
            start_new_session=True,
        )
        # The dashboard must not share the favour that the station's threads enjoy.
        os.setpriority(os.PRIO_PROCESS, self._process.pid, 0)

    def answers(self) -> bool:
        """Say whether the dashboard answers requests already."""
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
        """Return the exit code; None while it runs or when it was never started."""
        return None if self._process is None else self._process.poll()

    def terminate(self) -> None:
        """Ask the dashboard to end; returns at once."""
        self._signal(signal.SIGTERM)

    def kill(self) -> None:
        """End the dashboard and whatever it started; returns at once."""
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

    def _signal(self, number: signal.Signals) -> None:
        process = self._process
        if process is not None and process.poll() is None:
            os.killpg(process.pid, number)
