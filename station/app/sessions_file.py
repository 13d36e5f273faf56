"""The file from which a restarted dashboard restores its sessions.

There is one file per port, `<port>.sessions`, in the user's runtime directory, because
a browser sends its cookie to the same port again. The file is as private as the file
with the station's token, which is worth more than a session.
"""

import json
import logging
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from station.local.private_files import (
    RuntimeDirectoryError,
    read_private,
    runtime_directory,
    write_private,
)
from station.ui.sessions.sessions import KeptSession, Role

_logger = logging.getLogger(__name__)

_MOST = 150
"""Number of the newest sessions that are kept; more do not fit into a private file."""


@dataclass(frozen=True, slots=True)
class _Record:
    """The content of the file; `sessions` is a text with JSON."""

    station: str
    sessions: str


class SessionsFile:
    """Keeps the sessions of the dashboard at one port.

    Args:
        port: The port, not 0.
        station: URL of the API of the dashboard's station. A login at one station does
            not count at another one.
    """

    def __init__(self, port: int, station: str) -> None:
        self._name = f"{port}.sessions"
        self._station = station

    def move_to(self, station: str) -> None:
        """Keep the sessions for another station, which has replaced a crashed one."""
        self._station = station

    def load(self) -> list[KeptSession]:
        """Return the sessions last saved for this station; empty if there are none."""
        record = read_private(runtime_directory() / self._name, _Record)
        if record is None or record.station != self._station:
            return []
        try:
            return [
                KeptSession(
                    str(one["identifier"]),
                    Role(one["role"]),
                    str(one["token"]),
                    float(one["used_at"]),
                )
                for one in json.loads(record.sessions)
            ]
        except (ValueError, TypeError, KeyError):
            return []  # not our text: every user logs in again

    def save(self, sessions: Sequence[KeptSession]) -> None:
        """Save these sessions, oldest first, in place of those saved before.

        If the directory cannot be written, this is only logged: users must log in again
        after the next start.
        """
        kept = [
            {**asdict(session), "role": session.role.value}
            for session in sessions[-_MOST:]
        ]
        try:
            write_private(self._name, _Record(self._station, json.dumps(kept)))
        except RuntimeDirectoryError as error:
            _logger.warning("Sessions are not kept: %s %s", error, error.remedy)
