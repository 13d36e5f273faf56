"""The station's side of the watchdog: start it, report to it, and supervise it."""

import faulthandler
import fcntl
import json
import math
import mmap
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING

from station.api.auth import Authenticator
from station.app.watchdog.watch import WatchdogSettings
from station.config import StationConfig
from station.core.errors import StationError
from station.core.facade.station import Station
from station.core.loop.heartbeat import PAGE_BYTES, Heartbeat, Phase
from station.local.private_files import runtime_directory

if TYPE_CHECKING:
    from station.api.named_tokens import NamedToken

STACK_SIGNAL = signal.SIGRTMIN + 3
"""At this signal the interpreter's C code writes the stacks of all threads. This needs
no interpreter lock, so it works while a controller holds the lock."""
STARTING_TIME = 5.0
"""Longest start of the watchdog's interpreter [s]."""
_MAX_LINE = 4096
FINISH_TIMEOUT = 0.2
"""Longest wait for the watchdog to end [s]."""
RESTART_PERIOD = 1.0
"""Shortest time between two restarts of the watchdog [s]."""
LATE = 1.0
"""Age of the watchdog's last look that counts as a failure [s]; it looks every 0.01 s.
"""
HOPELESS = 3.0
"""Age of the last look at which the watchdog is killed and restarted [s]."""
_INCIDENTS = "incidents"


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


class EndedByWatchdogError(StationError, RuntimeError):
    """The watchdog has ended the station, because the control loop stood still."""

    code = "ended_by_watchdog"


class StationWatchdog:
    """The watchdog of one station, from its start to its end, in the main thread.

    Args:
        config: Configuration, which has the limits of the watchdog or disables it.
        warn: Called with a line about a problem.
        process: Its process; None makes one if the configuration enables the watchdog.
    """

    def __init__(
        self,
        config: StationConfig,
        warn: Callable[[str], None],
        process: WatchdogProcess | None = None,
    ) -> None:
        self._config = config
        self._warn = warn
        if config.watchdog.enabled and process is None:
            process = WatchdogProcess()
        self._process = process
        self._settings: WatchdogSettings | None = None
        self._may_start_at = 0.0
        self._authenticator: Authenticator | None = None
        self._told: dict[str, NamedToken] = {}
        # Without a watchdog, the loop writes its beats into memory that no other
        # process reads.
        self.heartbeat = self._process.heartbeat if self._process else Heartbeat()

    @property
    def url(self) -> str:
        """Return the URL of the watchdog; empty without a watchdog."""
        return self._process.url if self._process else ""

    def start(self, authenticator: Authenticator) -> None:
        """Start the process; until `guard` it only reports slow steps of the start."""
        if self._process is None:
            return
        limits = self._config.watchdog
        self._authenticator = authenticator
        self._settings = WatchdogSettings(
            pid=os.getpid(),
            operator_token=authenticator.operator_token,
            viewer_token=authenticator.viewer_token,
            incident_directory=str(runtime_directory() / _INCIDENTS),
            stack_signal=STACK_SIGNAL,
            # A cycle may use its whole period, and the next cycle may begin late.
            notice_after=max(limits.notice_after, 2.0 / self._config.station.rate),
            end_after=limits.end_after,
        )
        self._process.start(self._settings)

    def announce(self, step: str) -> None:
        """Report the next step of the start; the watchdog warns if it takes long.

        Args:
            step: Step of the start, e.g. `Loading the controller 'arm'`.
        """
        if self._process is not None:
            self._process.tell({"step": step})

    def guard(self, station: Station) -> None:
        """Let the watchdog react to a standstill of the loop from now on."""
        commands = tuple(map(tuple, station.loop.hw.hold_commands()))
        if self._process is not None and self._settings is not None:
            self._settings = self._settings._replace(hold_commands=commands)
            self._process.change(self._settings)
            self._process.tell(_status(station))
        self.heartbeat.phase = Phase.RUNNING

    def look(self, station: Station) -> None:
        """Publish the station's state, and restart a watchdog that has ended."""
        if self._process is None:
            return
        station.loop.cycle_yield.wait_if_cycle_is_due()
        # Give way before and after this piece of work, which takes a part of a period.
        status = _status(station)
        station.loop.cycle_yield.wait_if_cycle_is_due()
        self._process.tell(status)
        self._tell_tokens(self._process)
        now = station.loop.clock.now()
        if now < self._may_start_at:
            return
        code = self._process.start_again_if_ended()
        if code is None:
            self._look_at_its_beat(station, self._process, now)
            return
        # A watchdog that ends at once must not keep the station busy with restarts.
        self._may_start_at = now + RESTART_PERIOD
        self._told = {}
        station.watchdog_failure = f"The watchdog ended (exit code {code})."
        self._warn(f"{station.watchdog_failure} It is started again.")

    def _look_at_its_beat(
        self, station: Station, process: WatchdogProcess, now: float
    ) -> None:
        """Warn of a watchdog that runs but does not look: it is stopped, or hangs."""
        age = process.age(now)
        if age <= LATE:
            station.watchdog_failure = None
            return
        if station.watchdog_failure is None:
            self._warn(
                f"The watchdog has not looked at the loop for {age:.1f} s. It is "
                f"started anew if it does not look within {HOPELESS:g} s."
            )
        station.watchdog_failure = (
            "The watchdog runs and has not looked at the loop for more than "
            f"{LATE:g} s: it is suspended or hangs."
        )
        if age > HOPELESS:
            process.kill()

    def _tell_tokens(self, process: WatchdogProcess) -> None:
        """Report new and ended named tokens to the watchdog."""
        known = self._authenticator
        valid = {} if known is None else known.named.by_digest()
        # Report ended tokens first, so that none is valid for longer than necessary.
        for digest in self._told.keys() - valid.keys():
            process.tell_token({"digest": digest, "role": "", "expires": None})
        for digest in valid.keys() - self._told.keys():
            token = valid[digest]
            process.tell_token({
                "digest": digest,
                "role": token.role,
                "expires": token.expires,
            })
        self._told = valid

    def expect_end(self) -> None:
        """Tell the watchdog that an orderly end of the station begins."""
        self.heartbeat.phase = Phase.ENDING

    def finish(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.finish(FINISH_TIMEOUT)

    def check_end(self, cause: StationError | None = None) -> None:
        """Raise an error if the watchdog has ended the station.

        Args:
            cause: Error with which the station ended, if any.

        Raises:
            EndedByWatchdogError: The watchdog has ended the station.
        """
        if self.heartbeat.is_ended_by_watchdog:
            raise EndedByWatchdogError(
                "The watchdog ended the station: the control loop stood still for "
                f"more than {self._config.watchdog.end_after:g} s.",
                remedy=f"The newest file in {runtime_directory() / _INCIDENTS} says "
                "which controllers ran and where each thread was.",
            ) from cause


def _status(station: Station) -> dict[str, object]:
    """Return the station's status for the file of an incident, without a lock."""
    snapshot = station.snapshots.latest()
    if snapshot is None:
        return {}
    positions = zip(station.joint_names, snapshot.position, strict=True)
    return {
        "cycle": snapshot.cycle,
        "epoch": snapshot.epoch,
        "station_time": round(snapshot.stamp, 3),
        "robot_mode": snapshot.mode,
        "stop_state": station.loop.stop_latch.state.value,
        "running": ", ".join(station.manager.running_names()),
        "positions": {
            n: round(q, 4) if math.isfinite(q) else None for n, q in positions
        },
    }
