"""The dashboard's process: started with the station, gone with it."""

import os
import signal
import socket
import subprocess
import sys

from station.core.errors import StationError


class PortTakenError(StationError, OSError):
    """The dashboard cannot listen at its port."""

    code = "cannot_listen"


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
            raise PortTakenError(
                f"The dashboard cannot listen on {host}:{port}: {error.strerror}.",
                remedy="Choose another port with --ui-port (0 means any free one), "
                "end what has it, or run without dashboard: --no-ui.",
            ) from error
        return int(probe.getsockname()[1])


class UiProcess:
    """Runs `station ui` in a session of its own, so that Ctrl-C does not reach it.

    Its standard input is a pipe that closes when this process ends, however it ends;
    the dashboard ends itself then.

    Args:
        api_url: The station's API.
        token: The operator's token; handed over in the environment, which other users
            cannot see.
        host: Where the dashboard listens.
        port: Its port, not 0.
    """

    def __init__(self, api_url: str, token: str, host: str, port: int) -> None:
        self._command = [
            *(sys.executable, "-m", "station", "ui", "--connect", api_url),
            *("--host", host, "--port", str(port), "--until-stdin-closes"),
        ]
        self._token = token
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start the process; does not wait until the dashboard answers."""
        self._process = subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            env={**os.environ, "STATION_TOKEN": self._token},
            start_new_session=True,
        )

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
        if process.stdin is not None:
            process.stdin.close()

    def _signal(self, number: signal.Signals) -> None:
        process = self._process
        if process is not None and process.poll() is None:
            os.killpg(process.pid, number)
