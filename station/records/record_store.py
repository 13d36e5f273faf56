"""The folder of the recordings: files, what is known of each, and a quota.

Beside every `ID.mcap` lies `ID.json` with what a list shows, so that no file needs to
be opened for it. A description that says `recording` at the start of a station belongs
to one that was killed; its file is recovered then.
"""

import json
import os
import re
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

from station.core.errors import (
    RecordingFileError,
    RecordingNotFoundError,
    RecordingRefusedError,
    suggest,
)

NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,79}")
"""Names of recordings; they become part of the name of a file."""
_MOST_NAMED = 5
"""So many candidates are named when several recordings have a name, the newest."""
RECORDING, STOPPED, FAILED, RECOVERED = "recording", "stopped", "failed", "recovered"


@dataclass(frozen=True, slots=True)
class RecordingInfo:
    """What is known of a recording.

    Attributes:
        identifier: Its name in the folder.
        name: What the user calls it; empty without a name.
        note: What the user says about it.
        state: `recording`, `stopped`, `failed`, or `recovered` after a crash.
        error: Why it failed; None if it did not.
        started_at: When it began, ISO 8601.
        first_cycle: Its first cycle; 0 while it has none.
        last_cycle: Its last cycle; 0 while it has none.
        cycles: Number of cycles in it.
        lost: Cycles that were overwritten before they could be recorded.
        duration: Station time from its first cycle to its last [s].
        size: Bytes of the file.
        causes: Why an incident was kept; empty for what a user recorded.
    """

    identifier: str
    name: str = ""
    note: str = ""
    state: str = RECORDING
    error: str | None = None
    started_at: str = ""
    first_cycle: int = 0
    last_cycle: int = 0
    cycles: int = 0
    lost: int = 0
    duration: float = 0.0
    size: int = 0
    causes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Quota:
    """How much a folder may hold.

    Attributes:
        bytes: Most bytes of all files together.
        count: Most recordings.
    """

    bytes: int = 20_000_000_000
    count: int = 1000


class RecordStore:
    """The recordings in a folder. Any thread.

    Args:
        folder: Where the files are; made when the first one is begun.
        quota: How much it may hold.
        now: Returns the wall time [s since 1970].
    """

    def __init__(
        self,
        folder: Path,
        quota: Quota | None = None,
        now: Callable[[], float] = time.time,
    ) -> None:
        self.folder = folder
        self.quota = quota or Quota()
        self._now = now

    def begin(
        self, name: str = "", note: str = "", causes: tuple[str, ...] = ()
    ) -> tuple[RecordingInfo, Path]:
        """Describe a new recording; return it and the path of its file to be.

        Raises:
            RecordingRefusedError: The name is not allowed.
            RecordingFileError: The folder cannot be written to.
        """
        if name and not NAME.fullmatch(name):
            raise RecordingRefusedError(
                f"A recording cannot be called {name!r}.",
                remedy="Use up to 80 letters, digits, `_`, `.` and `-`.",
                details={"name": name},
            )
        now = self._now()
        thousandths = int(now % 1.0 * 1000.0)
        stamp = time.strftime("%Y%m%dT%H%M%S", time.gmtime(now)) + f"{thousandths:03d}"
        base = f"{stamp}-{name}" if name else stamp
        identifier, number = base, 1
        while self._description(identifier).exists():
            number += 1
            identifier = f"{base}-{number}"
        started = time.strftime("%Y-%m-%dT%H:%M:%S+00:00", time.gmtime(now))
        info = RecordingInfo(identifier, name, note, started_at=started, causes=causes)
        try:
            self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            self._write(info)
        except OSError as error:
            raise RecordingFileError(
                f"Nothing can be recorded in {self.folder}: {error}.",
                remedy="Make room, or configure another folder.",
            ) from error
        return info, self.file(identifier)

    def keep(self, info: RecordingInfo) -> OSError | None:
        """Write the description of a recording; return why it cannot be written.

        A disk that is full must not keep a recording from ending.
        """
        try:
            self._write(info)
        except OSError as error:
            return error
        return None

    def infos(self) -> list[RecordingInfo]:
        """Return all recordings, the oldest first."""
        paths = sorted(self.folder.glob("*.json"), key=lambda path: path.stem)
        found = (self._read(path) for path in paths)
        return [info for info in found if info is not None]

    def info(self, identifier: str) -> RecordingInfo:
        """Return one recording.

        Args:
            identifier: Which one; or its name, if no other one has it.

        Raises:
            RecordingNotFoundError: There is none of that name.
            RecordingRefusedError: Several have that name.
        """
        path = self._description(identifier)
        found = self._read(path) if NAME.fullmatch(identifier[:80]) else None
        if found is not None and "/" not in identifier:
            return found
        infos = self.infos()
        named = [one for one in infos if identifier and one.name == identifier]
        if len(named) == 1:
            return named[0]
        if named:
            which = [one.identifier for one in named]
            raise RecordingRefusedError(
                f"{len(named)} recordings are called '{identifier}'.",
                remedy=f"Say which one: {', '.join(which[-_MOST_NAMED:])}.",
                details={"id": identifier, "candidates": which},
            )
        raise RecordingNotFoundError(
            f"There is no recording '{identifier}'.",
            remedy=suggest(identifier, [one.identifier for one in infos]),
            details={"id": identifier},
        )

    def file(self, identifier: str) -> Path:
        """Return where the file of a recording is."""
        return self.folder / f"{identifier}.mcap"

    def delete(self, identifier: str) -> RecordingInfo:
        """Delete a recording that is not running; return what it was.

        Raises:
            RecordingNotFoundError: There is none of that name.
            RecordingRefusedError: It is being recorded, or several have that name.
        """
        info = self.info(identifier)
        if info.state == RECORDING:
            raise RecordingRefusedError(
                f"'{info.identifier}' is being recorded.", remedy="Stop it first."
            )
        self.file(info.identifier).unlink(missing_ok=True)
        self._description(info.identifier).unlink(missing_ok=True)
        return info

    def usage(self) -> int:
        """Return the bytes of all files together."""
        return sum(_size(path) for path in self.folder.glob("*.mcap"))

    def check_room(self) -> None:
        """Refuse a new recording when the folder is full.

        Raises:
            RecordingRefusedError: It is, and of what.
        """
        count, used = len(self.infos()), self.usage()
        if count >= self.quota.count or used >= self.quota.bytes:
            raise RecordingRefusedError(
                f"There are {count} recordings of {used} bytes; allowed are "
                f"{self.quota.count} of {self.quota.bytes} bytes together.",
                remedy="Delete recordings, or configure a larger quota.",
                details={"count": count, "bytes": used},
            )

    def recover(self) -> list[RecordingInfo]:
        """Recover what a killed station left; return the recordings it was about."""
        # Imported late: a list of recordings needs no reader of MCAP.
        from station.records.mcap_recovery import recover_file

        found = []
        for info in self.infos():
            if info.state != RECORDING:
                continue
            path = self.file(info.identifier)
            changed = replace(info, state=RECOVERED, size=_size(path))
            try:
                recovered = recover_file(path)
            except RecordingFileError as error:
                changed = replace(info, state=FAILED, error=error.message)
            else:
                note = (
                    f"The station was killed; {recovered.dropped} bytes were cut off."
                )
                changed = replace(info, state=RECOVERED, error=note, size=_size(path))
            self.keep(changed)
            found.append(changed)
        return found

    def drop_oldest(self, count: int) -> None:
        """Delete the oldest recordings, so that at most `count` are left."""
        infos = self.infos()
        for info in infos[: max(0, len(infos) - count)]:
            if info.state != RECORDING:
                self.delete(info.identifier)

    def _description(self, identifier: str) -> Path:
        return self.folder / f"{identifier}.json"

    def _write(self, info: RecordingInfo) -> None:
        path = self._description(info.identifier)
        draft = path.with_suffix(".draft")
        draft.write_text(json.dumps(asdict(info)), encoding="utf-8")
        draft.replace(path)

    def _read(self, path: Path) -> RecordingInfo | None:
        """Return a description; None when it is no longer there, or is not one."""
        try:
            values = json.loads(path.read_text(encoding="utf-8"))
            names = {one.name for one in fields(RecordingInfo)}
            known = {key: values[key] for key in names & values.keys()}
            known["causes"] = tuple(known.get("causes", ()))
            return RecordingInfo(**known)
        except (OSError, ValueError, TypeError, AttributeError):
            return None


def default_folder() -> Path:
    """Return the user's own folder of recordings."""
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(data) / "control-station" / "recordings"


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0
