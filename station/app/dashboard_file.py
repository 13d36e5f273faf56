"""The file by which a station finds a dashboard that has outlived another station.

One file per dashboard, `<pid>.dashboard`, in the user's runtime directory. The station
writes the file with its token, and the dashboard reads the file; programs of other
users can do neither.
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
