"""What the watchdog writes down when the loop of a station stands still or has died."""

import json
import os
import time

KEPT = 100
"""Incident files that are kept; the oldest go first."""


class Incident:
    """One incident, and the file that tells of it. The file is replaced as a whole.

    Args:
        directory: Where the file goes.
        pid: The station's process.
        facts: What is known at the beginning; more is added with `add`.

    Attributes:
        path: The file.
        facts: Everything that is known.
        failure: Why the file could not be written; None when it was. A full disk must
            not end the watchdog.
    """

    def __init__(self, directory: str, pid: int, facts: dict[str, object]) -> None:
        stamp = time.strftime("%Y%m%dT%H%M%S", time.gmtime())
        serial = time.monotonic_ns() // 1_000_000
        self.path = os.path.join(directory, f"{stamp}-{pid}-{serial}.json")
        self.facts = {"station_pid": pid, "began_at": stamp, **facts}
        self.failure: str | None = None
        self._directory = directory
        self._write()

    def add(self, **facts: object) -> None:
        """Add facts, or replace some, and write the file anew."""
        self.facts.update(facts)
        self._write()

    def _write(self) -> None:
        try:
            if not os.path.exists(self.path):
                os.makedirs(self._directory, mode=0o700, exist_ok=True)
                _forget_oldest(self._directory)
            self._replace()
        except OSError as error:
            self.failure = error.strerror
        else:
            self.failure = None

    def _replace(self) -> None:
        draft = f"{self.path}.draft"
        flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW
        with os.fdopen(os.open(draft, flags, 0o600), "w", encoding="utf-8") as file:
            json.dump(self.facts, file, indent=1)
        os.replace(draft, self.path)


def _forget_oldest(directory: str) -> None:
    names = sorted(name for name in os.listdir(directory) if name.endswith(".json"))
    for name in names[: max(len(names) - KEPT + 1, 0)]:
        os.unlink(os.path.join(directory, name))
