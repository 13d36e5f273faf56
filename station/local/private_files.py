"""Directories of this user's stations, and private files in them.

Files that exist while a station runs lie in `$XDG_RUNTIME_DIR/station`, or
`station-<uid>` in the system's temporary directory; only its user can enter it. A
reader of these files trusts neither their owner nor their content.

Files that outlive a station lie in `$XDG_STATE_HOME/control-station`, or
`~/.local/state/control-station`, in a directory for each station that runs at the same
time: `0`, `1`, … A station that starts takes the first directory that no running
station holds, so that a user with one station always gets the same directory.
"""

import fcntl
import json
import os
import stat
import tempfile
from dataclasses import Field, asdict, fields
from pathlib import Path
from typing import Any, ClassVar, Protocol, Self, TypeVar

from station.core.errors import StationError
from station.core.user_files import make_private_folder

_MAX_BYTES = 65_536
_MAX_PID = 2**22
"""Largest process number that Linux gives."""


class _Record(Protocol):
    """A dataclass of texts and numbers."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


RecordT = TypeVar("RecordT", bound=_Record)


class RuntimeDirectoryError(StationError, RuntimeError):
    """The directory of the runtime files belongs to another user, or cannot be used."""

    code = "runtime_directory"


def runtime_directory() -> Path:
    """Return the directory of the runtime files; it need not exist."""
    base = os.environ.get("XDG_RUNTIME_DIR")
    if base and Path(base).is_dir():
        return Path(base) / "station"
    return Path(tempfile.gettempdir()) / f"station-{os.getuid()}"


def process_start(pid: int) -> str:
    """Return the start time of a process, as the text of a number of clock ticks.

    Returns:
        Empty text for a process that has ended, also if its parent has not yet read its
        exit status (a zombie).
    """
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
    # The name in parentheses may hold anything, so count from its end: field 3, the
    # state, is the first one after it, and field 22, the start, is the 20th.
    fields_after_name = text.rpartition(")")[2].split()
    if len(fields_after_name) < 20 or fields_after_name[0] in "ZX":
        return ""
    return fields_after_name[19]


def is_alive(pid: int, started: str) -> bool:
    """Return whether a process of this user runs and began at that time.

    Args:
        pid: Its number.
        started: Start of the process, from `process_start`; empty if unknown, which
            skips the comparison.
    """
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return False  # another user's process has this number now
    return not started or process_start(pid) == started


def write_private(name: str, record: _Record) -> Path:
    """Write a file of the runtime directory; readable by its user only.

    Args:
        name: Name of the file.
        record: A dataclass of texts and numbers.

    Raises:
        RuntimeDirectoryError: The directory belongs to another user, or cannot be
            written.
    """
    directory = runtime_directory()
    path = directory / name
    try:
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        check_private(directory)
        path.unlink(missing_ok=True)
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
        with os.fdopen(os.open(path, flags, 0o600), "w", encoding="utf-8") as file:
            json.dump(asdict(record), file)
    except OSError as error:
        raise RuntimeDirectoryError(
            f"{path}: cannot be written: {error.strerror}.",
            remedy="Set XDG_RUNTIME_DIR to a directory that is yours.",
        ) from error
    return path


def read_private(path: Path, kind: type[RecordT]) -> RecordT | None:
    """Return the record in a file; None if the file holds no such record.

    Any program of the user may have left anything there: a pipe without a writer,
    a process number that means "everybody", lists a thousand levels deep.

    Args:
        path: The file.
        kind: A dataclass whose fields are texts, positive process numbers or tuples.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with os.fdopen(descriptor, "rb") as file:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                return None
            values = json.loads(file.read(_MAX_BYTES))
        record = kind(**values)
    except (OSError, ValueError, TypeError, RecursionError):
        return None
    if not all(_fits(getattr(record, f.name), f) for f in fields(record)):
        return None
    return record


def check_private(directory: Path) -> None:
    """Refuse a directory into which other users could have put a file.

    Raises:
        RuntimeDirectoryError: Other users can write into the directory.
    """
    info = directory.lstat()
    mode = stat.S_IMODE(info.st_mode)
    if not stat.S_ISDIR(info.st_mode) or info.st_uid != os.getuid() or mode & 0o022:
        raise RuntimeDirectoryError(
            f"{directory} is not a directory of yours alone (owner {info.st_uid}, "
            f"mode {mode:o}).",
            remedy="Remove it, or set XDG_RUNTIME_DIR to a directory that is yours.",
        )


def _fits(value: object, field: Field[Any]) -> bool:
    if field.type is int:
        return type(value) is int and 0 < value <= _MAX_PID
    return isinstance(value, str)


MOST_STATIONS = 64
"""Most stations of a user at the same time."""


class StateDirectoryError(StationError, OSError):
    """The directory of a station's state cannot be used."""

    code = "state_directory"


def state_directory() -> Path:
    """Return the directory of all stations of this user; it need not exist."""
    state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    return Path(state) / "control-station"


class StateDirectory:
    """The directory of one station, which no other running station has.

    The lock ends with the process, however it ends.

    Attributes:
        path: The directory; only its user can enter it.

    Raises:
        StateDirectoryError: The directory cannot be made, or too many stations run.
    """

    def __init__(self) -> None:
        base = state_directory()
        try:
            for number in range(MOST_STATIONS):
                path = base / str(number)
                make_private_folder(path)
                lock = os.open(path / "lock", os.O_CREAT | os.O_RDWR, 0o600)
                try:
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    os.close(lock)
                    continue
                self.path, self._lock = path, lock
                return
        except OSError as error:
            raise StateDirectoryError(
                f"{base} cannot be used: {error.strerror or error}.",
                remedy="Set XDG_STATE_HOME to a directory that is yours.",
            ) from error
        raise StateDirectoryError(
            f"{MOST_STATIONS} stations of this user run already.",
            remedy="End one of them, or set XDG_STATE_HOME to another directory.",
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Release the directory, so that another station may take it."""
        os.close(self._lock)
