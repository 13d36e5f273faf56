"""The watchdog's process, as the station starts it, feeds it and restarts it."""

import faulthandler
import fcntl
import json
import mmap
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import suppress

from station.app.watchdog.watch import WatchdogSettings
from station.core.loop.heartbeat import PAGE_BYTES, Heartbeat

STACK_SIGNAL = signal.SIGRTMIN + 3
"""At this signal the interpreter's C code writes the stacks of all threads. This needs
no interpreter lock, so it works while a controller holds the lock."""
STARTING_TIME = 5.0
"""Longest start of the watchdog's interpreter [s]."""
_MAX_LINE = 4096


class WatchdogProcess:
    """Starts the watchdog in a session of its own, so that Ctrl-C does not reach it.

    The shared page, the listening socket and the file of the stacks belong to the
    station, so that a restarted watchdog finds them unchanged. None of them has a name
    in the file system, so nothing remains however the station ends.

    Attributes:
        heartbeat: The page shared with the process.
        url: Address of the watchdog.
    """

    def __init__(self) -> None:
        # The page has no name in the file system, and vanishes with the last process
        # that has it open.
        self._page = os.memfd_create("station-heartbeat")
        os.ftruncate(self._page, PAGE_BYTES)
        self.heartbeat = Heartbeat(mmap.mmap(self._page, PAGE_BYTES))
        self._stacks = os.memfd_create("station-stacks")
        # The watchdog truncates the file between two uses, so writes must append.
        flags = fcntl.fcntl(self._stacks, fcntl.F_GETFL)
        fcntl.fcntl(self._stacks, fcntl.F_SETFL, flags | os.O_APPEND)
        faulthandler.register(STACK_SIGNAL, file=self._stacks, all_threads=True)
        # Created here, so that a restarted watchdog has the same address.
        self._listener = socket.create_server(("127.0.0.1", 0), backlog=32)
        self.url = f"http://127.0.0.1:{self._listener.getsockname()[1]}"
        self._settings: WatchdogSettings | None = None
        self._last_line = b""
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def pid(self) -> int | None:
        """Number of the watchdog's process; None before `start`."""
        return None if self._process is None else self._process.pid

    def start(self, settings: WatchdogSettings) -> None:
        """Start the process, without waiting until it watches."""
        self._settings = settings
        # Allow for the start of its interpreter before the first look.
        self.heartbeat.watchdog_beats[0] = time.monotonic() + STARTING_TIME
        inherited = (self._page, self._listener.fileno(), self._stacks)
        self._process = subprocess.Popen(
            [sys.executable, "-m", "station.app.watchdog", *map(str, inherited)],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            pass_fds=inherited,
            # Ctrl-C in the terminal begins an orderly end of the station, which the
            # watchdog must outlive.
            start_new_session=True,
        )
        pipe = self._process.stdin
        if pipe is None:
            return
        # The station must not wait for a watchdog that does not read; lines that do not
        # fit are lost.
        os.set_blocking(pipe.fileno(), False)
        self._write(_line({"settings": settings._asdict()}) + self._last_line)

    def change(self, settings: WatchdogSettings) -> None:
        """Replace the settings, also for a restarted watchdog."""
        self._settings = settings
        self._write(_line({"settings": settings._asdict()}))

    def tell(self, status: Mapping[str, object]) -> None:
        """Pass on the published state of the station, if it has changed.

        Args:
            status: JSON-compatible data; shortened if it is longer than 4 kB.
        """
        line = _line({"status": status})
        if len(line) > _MAX_LINE:
            # A pipe accepts at most this much in one piece.
            brief = {key: str(value)[:200] for key, value in status.items()}
            line = _line({"status": brief})
        if line != self._last_line:
            self._last_line = line
            self._write(line)

    def tell_token(self, token: Mapping[str, object]) -> None:
        """Pass on a named token that the watchdog must accept, or one that has ended.

        Args:
            token: `digest`, its SHA-256 in hexadecimal; `role`, empty for a token that
                has ended; `expires`, wall time when it expires [s since 1970], or None.
        """
        self._write(_line({"token": token}))

    def start_again_if_ended(self) -> int | None:
        """Start the process again if it has ended.

        Returns:
            The exit code of the ended process; None while it runs.
        """
        if self._process is None or self._settings is None:
            return None
        code = self._process.poll()
        if code is not None:
            self._close_pipe()
            self.start(self._settings)
        return code

    def age(self, now: float) -> float:
        """Return the time since the watchdog's last look; negative while it starts.

        Args:
            now: Monotonic time [s].
        """
        last = self.heartbeat.watchdog_beats[0]
        return now - last if last else 0.0

    def kill(self) -> None:
        """Kill a watchdog that hangs, so that `start_again_if_ended` restarts it."""
        if self._process is not None:
            self._process.kill()

    def finish(self, timeout: float) -> None:
        """End the process by closing its input; kill it after `timeout` [s]."""
        self._listener.close()
        if self._process is not None:
            self._close_pipe()
            try:
                # The closed pipe makes the watchdog end.
                self._process.wait(timeout)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        # Only after the watchdog has ended: without a handler its signal would kill the
        # station.
        faulthandler.unregister(STACK_SIGNAL)
        for descriptor in (self._page, self._stacks):
            os.close(descriptor)

    def _write(self, line: bytes) -> None:
        process = self._process
        if process is None or process.stdin is None:
            return
        # The pipe is full or the watchdog has ended, which `start_again_if_ended`
        # handles.
        with suppress(BlockingIOError, BrokenPipeError):
            os.write(process.stdin.fileno(), line)

    def _close_pipe(self) -> None:
        if self._process is not None and self._process.stdin is not None:
            self._process.stdin.close()


def _line(values: Mapping[str, object]) -> bytes:
    return json.dumps(values).encode() + b"\n"
