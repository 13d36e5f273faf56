"""The watchdog's process: `python -m station.app.watchdog PAGE LISTENER STACKS`.

The arguments are inherited file descriptors: the shared page, the listening socket, and
the file into which the station writes its stacks. Each line of the standard input is
JSON with settings (in the first line), a status of the station, or a named token. The
end of the input means that the station has ended.
"""

import fcntl
import json
import mmap
import os
import select
import signal
import socket
import sys
import time
from contextlib import suppress
from typing import Any

from station.app.watchdog.server import WatchdogServer
from station.app.watchdog.watch import LOOK_PERIOD, Watch, WatchdogSettings
from station.core.loop.heartbeat import PAGE_BYTES, Heartbeat

PRIORITY = 51
"""Requested SCHED_FIFO priority: one above that of the control thread, which may hang.
"""
_STACK_BYTES = 65_536


def main(page: int, listener: int, stacks: int) -> int:
    """Watch until the station ends; return the exit code."""
    for descriptor in (page, listener, stacks):
        fcntl.fcntl(
            descriptor, fcntl.F_SETFD, fcntl.FD_CLOEXEC
        )  # hold commands must not inherit it
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    station = _StationPipe(sys.stdin.fileno())
    lines = station.first_lines()
    if not lines:
        return 0
    settings = _settings(json.loads(lines.pop(0))["settings"])

    def read_stacks() -> str:
        return os.pread(stacks, _STACK_BYTES, 0).decode(errors="replace")

    watch = Watch(
        Heartbeat(mmap.mmap(page, PAGE_BYTES)),
        settings,
        tell=_tell,
        send=_Sender(settings.pid),
        forget_stacks=lambda: os.ftruncate(stacks, 0),
        read_stacks=read_stacks,
    )
    server = WatchdogServer(socket.socket(fileno=listener), settings, watch)
    for line in lines:
        _take(watch, server, json.loads(line))
    # A process forked from the station may keep the station's end of the pipe open, so
    # check the parent, too.
    while os.getppid() == settings.pid and not station.has_ended:
        descriptors = [station.descriptor, server.fileno()]
        ready, _, _ = select.select(descriptors, [], [], LOOK_PERIOD)
        lines = station.lines() if station.descriptor in ready else []
        with server.lock:
            for line in lines:
                _take(watch, server, json.loads(line))
            now = time.monotonic()
            watch.look(now)
        watch.heartbeat.watchdog_beats[0] = now
        server.handle_request()
    server.server_close()
    return 0


class _Sender:
    """Sends signals to the station, unless it has ended."""

    def __init__(self, pid: int) -> None:
        self._descriptor = os.pidfd_open(pid)

    def __call__(self, number: int) -> None:
        """Send the signal `number`."""
        with suppress(ProcessLookupError):
            signal.pidfd_send_signal(self._descriptor, number)


class _StationPipe:
    """The lines that the station writes to the watchdog."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self.has_ended = False
        self._rest = b""

    def first_lines(self) -> list[bytes]:
        """Wait for the first lines; return none if the station ends before."""
        lines: list[bytes] = []
        while not (lines or self.has_ended):
            lines = self.lines()
        return lines

    def lines(self) -> list[bytes]:
        """Read until a byte or the end comes; return the complete lines."""
        data = os.read(self.descriptor, 65_536)
        self.has_ended = not data
        *lines, self._rest = (self._rest + data).split(b"\n")
        return lines


def _take(
    watch: Watch, server: WatchdogServer, message: dict[str, dict[str, Any]]
) -> None:
    if "token" in message:
        server.take_token(**message["token"])
    elif "settings" in message:
        watch.take_settings(_settings(message["settings"]))
    else:
        watch.take_status(message["status"])


def _settings(values: dict[str, Any]) -> WatchdogSettings:
    values["hold_commands"] = tuple(tuple(one) for one in values["hold_commands"])
    return WatchdogSettings(**values)


def _tell(line: str) -> None:
    # The reader of the station's stderr may be gone, which must not end the watchdog.
    with suppress(OSError):
        os.write(2, f"watchdog: {line}\n".encode())


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
