"""The file by which a station finds a dashboard that outlived its predecessor.

One file per dashboard, `<pid>.dashboard`, in the user's runtime directory. The station
writes it, the dashboard reads it: who has a station's token there is the same user.
"""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from station.local.private_files import (
    check_private,
    is_alive,
    read_private,
    runtime_directory,
    write_private,
)


@dataclass(frozen=True, slots=True)
class DashboardRecord:
    """A dashboard's process, and the station it belongs to.

    Attributes:
        pid: The dashboard's process.
        started: When it started, as the system counts it.
        host: Host on which the dashboard listens.
        port: Its port.
        shown: Drawn robots and the version of the program, as one text; a
            station adopts a dashboard only if it would start the same.
        station_pid: The station's process.
        station_started: When that one started.
        api_url: The station's API.
        token: The operator's token.
        watchdog_url: The listener of the station's watchdog; empty when there is none.
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
    """Adopt a dashboard whose station has ended, before another station does.

    Files of dashboards that have ended are removed.

    Args:
        host: Host on which it must listen.
        port: Its port; 0: any.

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
            path.rename(taken)  # of two stations that start, one succeeds
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
