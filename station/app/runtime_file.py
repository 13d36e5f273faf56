"""The file by which programs of the same user find a running station and its token.

One file per station, `<pid>.json`, in a directory that only the user can enter:
`$XDG_RUNTIME_DIR/station`, or `station-<uid>` in the system's temporary directory.
"""

import json
import os
import stat
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

from station.core.errors import StationError

_MAX_BYTES = 65_536


class RuntimeDirectoryError(StationError, RuntimeError):
    """The directory of the runtime files is not the user's own, or cannot be used."""

    code = "runtime_directory"


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
    """

    url: str
    token: str
    viewer_token: str
    ui_url: str
    boot_id: str
    pid: int
    started: str


def runtime_directory() -> Path:
    """Return the directory of the runtime files; it need not exist."""
    base = os.environ.get("XDG_RUNTIME_DIR")
    if base and Path(base).is_dir():
        return Path(base) / "station"
    return Path(tempfile.gettempdir()) / f"station-{os.getuid()}"


def process_start(pid: int) -> str:
    """Return when a process started, in the system's own terms; empty if unknown."""
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
    # The name in parentheses may hold anything; field 22 is the 20th after it.
    return text.rpartition(")")[2].split()[19]


def write_runtime_file(running: RunningStation) -> Path:
    """Write the file of a station; readable by its user alone.

    Raises:
        RuntimeDirectoryError: The directory belongs to somebody else, or cannot be
            written.
    """
    directory = runtime_directory()
    path = directory / f"{running.pid}.json"
    try:
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        _check_private(directory)
        path.unlink(missing_ok=True)
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
        with os.fdopen(os.open(path, flags, 0o600), "w", encoding="utf-8") as file:
            json.dump(asdict(running), file)
    except OSError as error:
        raise RuntimeDirectoryError(
            f"{path}: cannot be written: {error.strerror}.",
            remedy="Set XDG_RUNTIME_DIR to a directory that is yours.",
        ) from error
    return path


def find_running() -> list[RunningStation]:
    """Return the stations of this user that run, oldest first.

    Files of processes that are gone are removed; what is no such file is ignored.

    Raises:
        RuntimeDirectoryError: The directory belongs to somebody else.
    """
    directory = runtime_directory()
    if not directory.is_dir():
        return []
    _check_private(directory)
    found: list[tuple[float, RunningStation]] = []
    for path in directory.glob("*.json"):
        running = _read(path)
        if running is None:
            continue
        if _is_alive(running):
            found.append((path.stat().st_mtime, running))
        else:
            path.unlink(missing_ok=True)
    return [running for _, running in sorted(found, key=lambda item: item[0])]


def _check_private(directory: Path) -> None:
    """Refuse a directory that others could have put something into.

    Raises:
        RuntimeDirectoryError: It is such a directory.
    """
    info = directory.lstat()
    mode = stat.S_IMODE(info.st_mode)
    if not stat.S_ISDIR(info.st_mode) or info.st_uid != os.getuid() or mode & 0o022:
        raise RuntimeDirectoryError(
            f"{directory} is not a directory of yours alone (owner {info.st_uid}, "
            f"mode {mode:o}).",
            remedy="Remove it, or set XDG_RUNTIME_DIR to a directory that is yours.",
        )


def _read(path: Path) -> RunningStation | None:
    try:
        with path.open("rb") as file:
            values = json.loads(file.read(_MAX_BYTES))
        return RunningStation(**values)
    except (OSError, ValueError, TypeError):
        return None


def _is_alive(running: RunningStation) -> bool:
    try:
        os.kill(running.pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return False  # somebody else's process by now
    return not running.started or process_start(running.pid) == running.started
