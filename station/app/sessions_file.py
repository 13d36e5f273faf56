"""The file by which a restarted dashboard knows its sessions.

One file per port, `<port>.sessions`, in the user's runtime directory: a browser sends
its cookie to the same port again. The file is as private as that with the station's
token, which is worth more than a session.
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
"""Sessions kept at most, the newest: more than that do not fit into a private file."""


@dataclass(frozen=True, slots=True)
class _Record:
    """The content of the file; the sessions are JSON inside a text."""

    station: str
    sessions: str


class SessionsFile:
    """Keeps the sessions of the dashboard at one port.

    Args:
        port: The port, not 0.
        station: The API of the station that the dashboard belongs to. Who logged in at
            one station is nobody at another one.
    """

    def __init__(self, port: int, station: str) -> None:
        self._name = f"{port}.sessions"
        self._station = station

    def move_to(self, station: str) -> None:
        """Belong to another station, which took the place of a crashed one."""
        self._station = station

    def load(self) -> list[KeptSession]:
        """Return the sessions that this station saved last; empty if none are its."""
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
            return []  # somebody else's text: everybody logs in again

    def save(self, sessions: Sequence[KeptSession]) -> None:
        """Keep these sessions, oldest first, instead of those kept before.

        A directory that cannot be written costs a login after the next start, and not
        this one: that is only logged.
        """
        kept = [
            {**asdict(session), "role": session.role.value}
            for session in sessions[-_MOST:]
        ]
        try:
            write_private(self._name, _Record(self._station, json.dumps(kept)))
        except RuntimeDirectoryError as error:
            _logger.warning("Sessions are not kept: %s %s", error, error.remedy)
