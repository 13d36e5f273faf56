"""The station's side of its watchdog: starts the process, feeds it, starts it again."""

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
"""Upon this signal the interpreter's C code writes the stacks of all threads; it needs
no interpreter lock for that, so it works while a controller holds the lock."""
STARTING_TIME = 5.0
"""How long the interpreter of the watchdog may take to start [s]."""
_MAX_LINE = 4096


class WatchdogProcess:
    """Starts the watchdog in a session of its own, so that Ctrl-C does not reach it.

    The shared page, the listening socket and the file of the stacks belong to the
    station, so that a watchdog that is started again finds them as they were. None of
    them has a name in the file system: nothing stays behind, however the station ends.

    Attributes:
        heartbeat: The page shared with the process.
        url: Address of the watchdog.
    """

    def __init__(self) -> None:
        # Without a name in the file system: it goes with the last process that has it
        # open.
        self._page = os.memfd_create("station-heartbeat")
        os.ftruncate(self._page, PAGE_BYTES)
        self.heartbeat = Heartbeat(mmap.mmap(self._page, PAGE_BYTES))
        self._stacks = os.memfd_create("station-stacks")
        # The watchdog empties the file between two uses; writing goes to its end.
        flags = fcntl.fcntl(self._stacks, fcntl.F_GETFL)
        fcntl.fcntl(self._stacks, fcntl.F_SETFL, flags | os.O_APPEND)
        faulthandler.register(STACK_SIGNAL, file=self._stacks, all_threads=True)
        # Made here, so that the address stays the same when the watchdog is started
        # again.
        self._listener = socket.create_server(("127.0.0.1", 0), backlog=32)
        self.url = f"http://127.0.0.1:{self._listener.getsockname()[1]}"
        self._settings: WatchdogSettings | None = None
        self._last_line = b""
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def pid(self) -> int | None:
        """The watchdog's process; None before `start`."""
        return None if self._process is None else self._process.pid

    def start(self, settings: WatchdogSettings) -> None:
        """Start the process; does not wait until it watches."""
        self._settings = settings
        # It looks for the first time when its interpreter has started.
        self.heartbeat.watchdog_beats[0] = time.monotonic() + STARTING_TIME
        inherited = (self._page, self._listener.fileno(), self._stacks)
        self._process = subprocess.Popen(
            [sys.executable, "-m", "station.app.watchdog", *map(str, inherited)],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            pass_fds=inherited,
            # Ctrl-C in the terminal ends the station in order; the watchdog must
            # outlive that.
            start_new_session=True,
        )
        pipe = self._process.stdin
        if pipe is None:
            return
        # Nobody may wait for a watchdog that does not read: what does not fit is lost.
        os.set_blocking(pipe.fileno(), False)
        self._write(_line({"settings": settings._asdict()}) + self._last_line)

    def change(self, settings: WatchdogSettings) -> None:
        """Replace the settings, for a watchdog that is started again, too."""
        self._settings = settings
        self._write(_line({"settings": settings._asdict()}))

    def tell(self, status: Mapping[str, object]) -> None:
        """Pass on the published state of the station, if it has changed.

        Args:
            status: JSON-compatible; cut off where it gets longer than 4 kB.
        """
        line = _line({"status": status})
        if len(line) > _MAX_LINE:
            # A pipe takes at most this much in one piece.
            brief = {key: str(value)[:200] for key, value in status.items()}
            line = _line({"status": brief})
        if line != self._last_line:
            self._last_line = line
            self._write(line)

    def tell_token(self, token: Mapping[str, object]) -> None:
        """Hand on a named token that the watchdog accepts, or one that has ended.

        Args:
            token: `digest`, its SHA-256 in hexadecimal; `role`, empty for a token that
                has ended; `expires`, wall time when it ends [s since 1970], or None.
        """
        self._write(_line({"token": token}))

    def start_again_if_ended(self) -> int | None:
        """Start the process again when it has ended.

        Returns:
            The exit code of the process that has ended; None while it runs.
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
        """Kill a watchdog that hangs, for `start_again_if_ended`."""
        if self._process is not None:
            self._process.kill()

    def finish(self, timeout: float) -> None:
        """End the process by closing its input; kill it after `timeout` [s]."""
        self._listener.close()
        if self._process is not None:
            self._close_pipe()
            try:
                # The closed pipe tells it to end.
                self._process.wait(timeout)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        # Not before the watchdog has ended: without a handler its signal would kill.
        faulthandler.unregister(STACK_SIGNAL)
        for descriptor in (self._page, self._stacks):
            os.close(descriptor)

    def _write(self, line: bytes) -> None:
        process = self._process
        if process is None or process.stdin is None:
            return
        # A full pipe or a dead watchdog: `start_again_if_ended` sees to the latter.
        with suppress(BlockingIOError, BrokenPipeError):
            os.write(process.stdin.fileno(), line)

    def _close_pipe(self) -> None:
        if self._process is not None and self._process.stdin is not None:
            self._process.stdin.close()


def _line(values: Mapping[str, object]) -> bytes:
    return json.dumps(values).encode() + b"\n"
