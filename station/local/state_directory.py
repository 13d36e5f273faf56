"""The directory of the files of this user's station that outlive it.

`$XDG_STATE_HOME/control-station`, or `~/.local/state/control-station`, has a directory
for each station that runs at the same time: `0`, `1`, … A station that starts takes the
first that no running station has, so that one station always finds its own again.
"""

import fcntl
import os
from pathlib import Path
from typing import Self

from station.core.errors import StationError
from station.core.user_files import make_private_folder

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
        """Let another station have the directory."""
        os.close(self._lock)
