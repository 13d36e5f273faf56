"""The file by which programs of the same user find a running station and its token.

One file per station, `<pid>.json`, in the user's runtime directory.
"""

from contextlib import suppress
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
class RunningStation:
    """Where a station runs and how to get in.

    Attributes:
        url: The API.
        token: The operator's token.
        viewer_token: Token for watching alone.
        ui_url: The dashboard; empty when there is none.
        boot_id: Changes with every start.
        pid: Its process.
        started: When that process started, as the system counts it; tells a process
            from a later one with the same number. Empty where unknown.
        watchdog_url: The listener of its watchdog; empty when there is none.
        certificate: The file of the certificate it serves with; empty without TLS.
    """

    url: str
    token: str
    viewer_token: str
    ui_url: str
    boot_id: str
    pid: int
    started: str
    watchdog_url: str = ""
    certificate: str = ""


def write_runtime_file(running: RunningStation) -> Path:
    """Write the file of a station; readable by its user alone.

    Raises:
        RuntimeDirectoryError: The directory belongs to somebody else, or cannot be
            written.
    """
    return write_private(f"{running.pid}.json", running)


def find_running() -> list[RunningStation]:
    """Return the stations of this user that run, oldest first.

    Files of processes that are gone are removed; what is no such file is ignored.

    Raises:
        RuntimeDirectoryError: The directory belongs to somebody else.
    """
    directory = runtime_directory()
    if not directory.is_dir():
        return []
    check_private(directory)
    found: list[tuple[float, RunningStation]] = []
    for path in directory.glob("*.json"):
        running = read_private(path, RunningStation)
        if running is None:
            continue
        if is_alive(running.pid, running.started):
            # A station that ends meanwhile takes its file away.
            with suppress(FileNotFoundError):
                found.append((path.stat().st_mtime, running))
        else:
            path.unlink(missing_ok=True)
    return [running for _, running in sorted(found, key=lambda item: item[0])]
