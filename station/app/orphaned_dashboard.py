"""A dashboard whose station has ended: it waits for the next station, which finds it.

There is one file per dashboard, `<pid>.dashboard`, in the user's runtime directory. The
station writes the file with its token, and the dashboard reads the file; programs of
other users can do neither.

A thread of the dashboard's process watches its station. It starts before slow imports,
so that a station that is killed in these seconds leaves no dashboard behind.
"""

import os
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from station.local.private_files import (
    check_private,
    is_alive,
    process_start,
    read_private,
    runtime_directory,
    write_private,
)
from station.ui.link.station_access import StationAccess

LOOK_PERIOD = 0.1
"""Time between two looks of the thread [s]."""
ENDING_TIME = 3.0
"""Longest orderly end of a dashboard that no station has adopted [s]."""


@dataclass(frozen=True, slots=True)
class DashboardRecord:
    """The process of a dashboard, and the station that it shows.

    Attributes:
        pid: Process number of the dashboard.
        started: When the dashboard started, from `process_start`.
        host: Host on which the dashboard listens.
        port: Its port.
        shown: Drawn robots and version of the program, as one text; a station adopts a
            dashboard only if it would start one with the same text.
        station_pid: Process number of the station.
        station_started: When the station started, from `process_start`.
        api_url: URL of the station's API.
        token: The operator's token.
        watchdog_url: URL of the station's watchdog; empty without a watchdog.
        viewer_token: The viewer's token; empty when it is not known.
    """

    pid: int
    started: str
    host: str
    port: int
    shown: str
    station_pid: int
    station_started: str
    api_url: str
    token: str
    watchdog_url: str
    viewer_token: str = ""

    def write(self) -> Path:
        """Write the file, or replace it.

        Raises:
            RuntimeDirectoryError: The directory belongs to another user, or cannot be
                written.
        """
        return write_private(dashboard_path(self.pid).name, self)


def dashboard_path(pid: int) -> Path:
    """Return the file of the dashboard with this process number."""
    return runtime_directory() / f"{pid}.dashboard"


def read_dashboard(pid: int) -> DashboardRecord | None:
    """Return the record of a dashboard; None while a station is about to adopt it."""
    return read_private(dashboard_path(pid), DashboardRecord)


def claim_orphan(host: str, port: int) -> DashboardRecord | None:
    """Claim a dashboard whose station has ended, so that no other station adopts it.

    Files of dashboards that have ended are deleted.

    Args:
        host: Host at which the dashboard must listen.
        port: Its port; 0 accepts any port.

    Returns:
        The dashboard, or None when there is none.

    Raises:
        RuntimeDirectoryError: The directory belongs to another user.
    """
    for path, record in _records():
        if not is_alive(record.pid, record.started):
            path.unlink(missing_ok=True)
            continue
        if is_alive(record.station_pid, record.station_started):
            continue
        if record.host != host or port not in {0, record.port}:
            continue
        taken = path.with_suffix(f".taken-{os.getpid()}")
        try:
            path.rename(taken)  # only one of two starting stations succeeds
        except FileNotFoundError:
            continue
        taken.unlink()
        return record
    return None


def _records() -> Iterator[tuple[Path, DashboardRecord]]:
    directory = runtime_directory()
    if not directory.is_dir():
        return
    check_private(directory)
    for path in directory.glob("*.dashboard"):
        record = read_private(path, DashboardRecord)
        if record is not None:
            yield path, record


class StationWatch:
    """Follows the station that started this process, and its successors.

    A dashboard that is still starting ends at once with its station, because no user
    has logged in. A serving dashboard waits `window` seconds for a station that adopts
    it, so that a crash does not log users out. Then it ends, because it holds a token.

    Args:
        parent: Process number of the station.
        access: Address and tokens of the station.
        window: How long to wait for another station [s], >= 0.
    """

    def __init__(self, parent: int, access: StationAccess, window: float) -> None:
        self._station = (parent, process_start(parent))
        self._window = window
        self.access: StationAccess | None = access
        self.is_serving = False
        self.is_over = False

    def start(self) -> bool:
        """Start the thread; return False if the station has already ended."""
        if os.getppid() != self._station[0]:
            return False
        threading.Thread(target=self._run, name="station-watch", daemon=True).start()
        return True

    def _run(self) -> None:
        lost_since: float | None = None
        while True:
            now = time.monotonic()
            if is_alive(*self._station) or self._is_adopted():
                lost_since = None
            # The dashboard does not serve yet, so no session is lost.
            elif not self.is_serving:
                os._exit(0)
            elif lost_since is None:
                lost_since = now
                self.access = None
            elif now - lost_since > self._window:
                break
            time.sleep(LOOK_PERIOD)
        self.is_over = True
        dashboard_path(os.getpid()).unlink(missing_ok=True)
        # Even a dashboard that hangs must not keep the token.
        time.sleep(ENDING_TIME)
        # `sys.exit` would end this thread only.
        os._exit(1)

    def _is_adopted(self) -> bool:
        record = read_dashboard(os.getpid())
        if record is None:
            return False
        station = (record.station_pid, record.station_started)
        # The record may still name the station that has just ended.
        if station == self._station or not is_alive(*station):
            return False
        self._station = station
        self.access = StationAccess(
            record.api_url, record.token, record.watchdog_url, record.viewer_token
        )
        return True
