"""The folder of the recordings: files, their descriptions, and a quota.

Beside every `ID.mcap` lies a description `ID.json`, so that a list of recordings need
not open the recordings. A file is locked while it is written. A description that says
`recording`, beside a file without a lock, belongs to a station that was killed; the
file is recovered when the next station starts.
"""

import json
import os
import re
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from station.core.errors import (
    RecordingFileError,
    RecordingNotFoundError,
    RecordingRefusedError,
    suggest,
)
from station.core.user_files import (
    is_locked,
    make_private_folder,
    open_regular,
    read_regular,
    try_lock,
    user_folder,
)

if TYPE_CHECKING:
    from station.records.mcap_recovery import Recovered

NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,79}")
"""Names of recordings; they become part of the name of a file."""
_MOST_NAMED = 5
"""Number of the newest candidates that an error names when several recordings have the
same name."""
_LARGEST = 65_536
"""Largest description that is read [bytes]."""
_MOST_ATTEMPTS = 1000
KILLED = "The station that recorded it was killed; a station recovers it at its start."
"""Reason of the failure of a recording that is not recovered yet."""
RECORDING, STOPPED, FAILED, RECOVERED = "recording", "stopped", "failed", "recovered"


@dataclass(frozen=True, slots=True)
class RecordingInfo:
    """The description of a recording.

    Attributes:
        identifier: Its name in the folder.
        name: Name that the user gave; empty without a name.
        note: Note of the user.
        state: `recording`, `stopped`, `failed`, or `recovered` after a crash.
        error: Why it failed; None if it did not.
        started_at: When it began, ISO 8601.
        first_cycle: Its first cycle; 0 while it has none.
        last_cycle: Its last cycle; 0 while it has none.
        cycles: Number of cycles in it.
        lost: Cycles that were overwritten before they could be recorded.
        duration: Station time from its first cycle to its last [s].
        size: Bytes of the file.
        causes: Causes of an incident; empty for a recording of a user.
        is_uploaded: Whether it was uploaded as a file instead of recorded here.
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
    is_uploaded: bool = False


@dataclass(frozen=True, slots=True)
class Quota:
    """The limits of a folder's size.

    Attributes:
        bytes: Most bytes of all files together.
        count: Most recordings.
    """

    bytes: int = 20_000_000_000
    count: int = 1000


class _File(Protocol):
    def close(self) -> None: ...


FileT = TypeVar("FileT", bound=_File)


class RecordStore:
    """The recordings in a folder. Any thread.

    Args:
        folder: Folder of the files; made with the first recording.
        quota: Limits of the folder's size; None for the default limits.
        noun: Noun for one of them in messages.
        now: Returns the wall time [s since 1970].
    """

    def __init__(
        self,
        folder: Path,
        quota: Quota | None = None,
        noun: str = "recording",
        now: Callable[[], float] = time.time,
    ) -> None:
        self.folder = folder
        self.noun = noun
        self.quota = quota or Quota()
        self._now = now

    def begin(
        self,
        open_file: Callable[[Path], FileT],
        name: str = "",
        note: str = "",
        causes: tuple[str, ...] = (),
    ) -> tuple[RecordingInfo, FileT]:
        """Make the file of a new recording and describe it.

        Args:
            open_file: Function that makes a new file and locks it.
            name: Name that the user gives.
            note: Note of the user.
            causes: Why an incident is kept.

        Raises:
            RecordingRefusedError: The name is not allowed.
            RecordingFileError: The folder cannot be written to.
            OSError: Never raised: it becomes a `RecordingFileError`.
        """
        self.check_name(name)
        now = self._now()
        thousandths = int(now % 1.0 * 1000.0)
        stamp = time.strftime("%Y%m%dT%H%M%S", time.gmtime(now)) + f"{thousandths:03d}"
        base = f"{stamp}-{name}" if name else stamp
        started = time.strftime("%Y-%m-%dT%H:%M:%S+00:00", time.gmtime(now))
        info = RecordingInfo(base, name, note, started_at=started, causes=causes)
        try:
            make_private_folder(self.folder)
            # Make the file, which is locked from the beginning, before its description.
            # Another station that finds the description then also finds the lock.
            identifier, file = self._open_free(base, open_file)
            info = replace(info, identifier=identifier)
            failure = self.keep(info)
            if failure is not None:
                file.close()
                self.file(identifier).unlink(missing_ok=True)
                raise failure
        except OSError as error:
            self.keep(replace(info, state=FAILED, error=str(error)))
            raise RecordingFileError(
                f"Nothing can be recorded in {self.folder}: {error}.",
                remedy="Make room, or configure another folder.",
            ) from error
        return info, file

    def _open_free(
        self, base: str, open_file: Callable[[Path], FileT]
    ) -> tuple[str, FileT]:
        """Return a new identifier and its new file.

        Raises:
            FileExistsError: All names are taken.
            OSError: The file cannot be made.
        """
        for number in range(1, _MOST_ATTEMPTS):
            identifier = base if number == 1 else f"{base}-{number}"
            if self._description(identifier).exists():
                continue
            # Another station may take the name at the same moment.
            with suppress(FileExistsError):
                return identifier, open_file(self.file(identifier))
        raise FileExistsError(f"{base} and {_MOST_ATTEMPTS} other names are taken")

    def keep(self, info: RecordingInfo) -> OSError | None:
        """Write the description of a recording; return why it cannot be written.

        It returns the error instead of raising it, because a full disk must not keep a
        recording from ending.
        """
        try:
            self._write(info)
        except OSError as error:
            return error
        return None

    def infos(self) -> list[RecordingInfo]:
        """Return all recordings with a usable description, the oldest first."""
        found = (self._presented(path) for path in self._descriptions())
        return [info for info in found if info is not None]

    def skipped(self) -> list[str]:
        """Return the unusable descriptions in the folder, each with the reason."""
        found = []
        for path in self._descriptions():
            try:
                self._read(path)
            except FileNotFoundError:
                continue  # deleted meanwhile
            except (OSError, ValueError) as error:
                found.append(f"{path.name}: {error}")
        return found

    def info(self, identifier: str) -> RecordingInfo:
        """Return one recording.

        Args:
            identifier: Id of the recording, or its name if that is unique.

        Raises:
            RecordingNotFoundError: There is no such recording.
            RecordingRefusedError: Several recordings have that name.
        """
        path = self._description(identifier)
        is_segment = NAME.fullmatch(identifier[:80]) and "/" not in identifier
        found = self._presented(path) if is_segment else None
        if found is not None:
            return found
        infos = self.infos()
        named = [one for one in infos if identifier and one.name == identifier]
        if len(named) == 1:
            return named[0]
        if named:
            which = [one.identifier for one in named]
            raise RecordingRefusedError(
                f"{len(named)} {self.noun}s are called '{identifier}'.",
                remedy=f"Say which one: {', '.join(which[-_MOST_NAMED:])}.",
                details={"id": identifier, "candidates": which},
            )
        raise RecordingNotFoundError(
            f"There is no {self.noun} '{identifier}'.",
            remedy=suggest(identifier, [one.identifier for one in infos]),
            details={"id": identifier},
        )

    def file(self, identifier: str) -> Path:
        """Return the path of a recording's file."""
        return self.folder / f"{identifier}.mcap"

    def delete(self, identifier: str) -> RecordingInfo:
        """Delete a recording that is not running; return its description.

        Raises:
            RecordingNotFoundError: There is no such recording.
            RecordingRefusedError: The recording is not finished, or several recordings
                have that name.
            RecordingFileError: The folder cannot be written to.
        """
        info = self.info(identifier)
        path = self.file(info.identifier)
        # Lock the file until it is deleted, so that no station begins to recover it.
        descriptor = _locked(path)
        if descriptor is None or info.state == RECORDING:
            _close(descriptor)
            raise RecordingRefusedError(
                f"'{info.identifier}' is being recorded, by this station or another.",
                remedy="Stop it first.",
                details={"id": info.identifier},
            )
        try:
            path.unlink(missing_ok=True)
            self._description(info.identifier).unlink(missing_ok=True)
        except OSError as error:
            raise RecordingFileError(
                f"'{info.identifier}' cannot be deleted: {error.strerror}.",
                remedy=f"See who may write to {self.folder}.",
            ) from error
        finally:
            _close(descriptor)
        return info

    def usage(self) -> int:
        """Return the bytes of all files together."""
        return sum(_size(path) for path in self.folder.glob("*.mcap"))

    @staticmethod
    def check_name(name: str) -> None:
        """Refuse a name that cannot be a part of a file's name.

        Raises:
            RecordingRefusedError: The name is not allowed; an empty name is allowed.
        """
        if name and not NAME.fullmatch(name):
            raise RecordingRefusedError(
                f"A recording cannot be called {name!r}.",
                remedy="Use up to 80 letters, digits, `_`, `.` and `-`.",
                details={"name": name},
            )

    def check_room(self) -> None:
        """Refuse a new recording when the folder is full.

        Raises:
            RecordingRefusedError: The folder is full of files or bytes.
        """
        count, used = len(self.infos()), self.usage()
        if count >= self.quota.count or used >= self.quota.bytes:
            raise RecordingRefusedError(
                f"There are {count} recordings of {used} bytes; allowed are "
                f"{self.quota.count} of {self.quota.bytes} bytes together.",
                remedy="Delete recordings, or configure a larger quota.",
                details={"count": count, "bytes": used},
            )

    def interrupted(self) -> list[str]:
        """Return the recordings that a killed station has left, by identifier."""
        found = []
        for path in self._descriptions():
            with suppress(OSError, ValueError):
                info = self._read(path)
                if info.state == RECORDING and not is_locked(self.file(path.stem)):
                    found.append(info.identifier)
        return found

    def recover(
        self,
        pause: Callable[[], None] = lambda: None,
        tell: Callable[[RecordingInfo], None] = lambda _: None,
    ) -> list[RecordingInfo]:
        """Recover the recordings of a killed station; return their descriptions.

        Args:
            pause: Called between short pieces of work.
            tell: Called with each recording after its recovery.
        """
        found = []
        for identifier in self.interrupted():
            info = self.recover_one(identifier, pause)
            if info is not None:
                found.append(info)
                tell(info)
        return found

    def recover_one(
        self, identifier: str, pause: Callable[[], None] = lambda: None
    ) -> RecordingInfo | None:
        """Recover one recording; None when another station has it.

        Args:
            identifier: Id of the recording; it has a description.
            pause: Called between short pieces of work.
        """
        # Imported late: a list of recordings needs no reader of MCAP.
        from station.records.mcap_recovery import recover_file

        try:
            info = self._read(self._description(identifier))
            recovered = recover_file(self.file(identifier), pause)
        except RecordingFileError as error:
            info = replace(info, state=FAILED, error=error.message)
            self.keep(info)
            return info
        except (OSError, ValueError, RecordingRefusedError):
            return None  # deleted meanwhile, or another station has it
        return self.note_recovery(identifier, recovered)

    def note_recovery(
        self, identifier: str, recovered: "Recovered"
    ) -> RecordingInfo | None:
        """Write the result of a recovery into the description; None if there is none.

        Args:
            identifier: The recording.
            recovered: Findings of the recovery.
        """
        try:
            info = self._read(self._description(identifier))
        except (OSError, ValueError):
            return None
        was_killed = info.state == RECORDING
        if not was_killed and not recovered.is_changed:
            return info
        why = "The station was killed. " if was_killed else ""
        info = replace(
            info,
            state=RECOVERED,
            error=f"{why}{recovered.text()}".strip(),
            size=_size(self.file(identifier)),
            cycles=recovered.cycles,
            first_cycle=recovered.first_cycle,
            last_cycle=recovered.last_cycle,
            lost=max(info.lost, recovered.lost_cycles),
            duration=recovered.duration,
        )
        self.keep(info)
        return info

    def drop_oldest(self, count: int) -> None:
        """Delete the oldest recordings, so that at most `count` are left."""
        infos = self.infos()
        for info in infos[: max(0, len(infos) - count)]:
            # Another station may still write the file, or may have deleted it.
            with suppress(RecordingRefusedError, RecordingNotFoundError):
                self.delete(info.identifier)

    def _description(self, identifier: str) -> Path:
        return self.folder / f"{identifier}.json"

    def _write(self, info: RecordingInfo) -> None:
        path = self._description(info.identifier)
        draft = path.with_suffix(".draft")
        try:
            draft.write_text(json.dumps(asdict(info)), encoding="utf-8")
            draft.replace(path)
        except OSError:
            draft.unlink(missing_ok=True)
            raise

    def _descriptions(self) -> list[Path]:
        return sorted(self.folder.glob("*.json"), key=lambda path: path.stem)

    def _presented(self, path: Path) -> RecordingInfo | None:
        """Return a description in its present state; None when it is unusable."""
        try:
            info = self._read(path)
        except (OSError, ValueError):
            return None
        if info.state == RECORDING and not is_locked(self.file(info.identifier)):
            return replace(info, state=FAILED, error=KILLED)
        return info

    def _read(self, path: Path) -> RecordingInfo:
        """Return a description.

        Raises:
            OSError: The file cannot be read.
            ValueError: The text is not a description, or belongs to another file.
        """
        values = json.loads(read_regular(path, _LARGEST))
        if not isinstance(values, dict):
            raise ValueError("it has no mapping")  # noqa: TRY004 - of a file
        # Check the identifier, because it becomes part of a path.
        if values.get("identifier") != path.stem or not NAME.match(path.stem):
            raise ValueError("it is the description of another file")
        return _checked(values)


def default_folder() -> Path:
    """Return the user's own folder of recordings."""
    return user_folder("recordings")


def _checked(values: Mapping[str, object]) -> RecordingInfo:
    """Return the content of a description.

    Raises:
        ValueError: A value has a wrong type.
    """
    default = RecordingInfo("")
    known: dict[str, Any] = {}
    for one in fields(RecordingInfo):
        value = values.get(one.name, getattr(default, one.name))
        if one.name == "causes" and isinstance(value, list):
            value = tuple(map(str, value))
        allowed: tuple[type, ...] = (type(getattr(default, one.name)),)
        if one.name in {"error", "duration"}:
            allowed = (str, NoneType) if one.name == "error" else (int, float)
        if type(value) not in allowed:
            raise ValueError(f"its '{one.name}' is {value!r:.100}")
        known[one.name] = value
    if known["state"] not in {RECORDING, STOPPED, FAILED, RECOVERED}:
        raise ValueError(f"its 'state' is {known['state']!r:.100}")
    return RecordingInfo(**known)


def _locked(path: Path) -> int | None:
    """Return a descriptor that locks a file, -1 without a file; None if it is taken."""
    try:
        descriptor = open_regular(path)
    except OSError:
        return -1
    if try_lock(descriptor):
        return descriptor
    os.close(descriptor)
    return None


def _close(descriptor: int | None) -> None:
    if descriptor is not None and descriptor >= 0:
        os.close(descriptor)


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0
