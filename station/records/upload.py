"""Store an uploaded recording, from this station or another one."""

import tempfile
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from station.core.errors import RecordingFileError, RecordingRefusedError
from station.core.user_files import make_private_folder
from station.records.mcap_recovery import recover_file
from station.records.mcap_scan import DAMAGE
from station.records.record_store import STOPPED, RecordingInfo, RecordStore
from station.records.recording_table import RecordingTable


class Upload:
    """An upload in progress; the store lists it after the file is found complete.

    Args:
        store: Folder of the recordings.
        name: Name of the recording; may be empty.

    Raises:
        RecordingRefusedError: The name is not allowed, or the store is full.
        RecordingFileError: The folder cannot be written to.
    """

    def __init__(self, store: RecordStore, name: str = "") -> None:
        store.check_name(name)
        store.check_room()
        self._store = store
        self._name = name
        try:
            make_private_folder(store.folder)
            # In the folder of the recordings, so that it need not be copied; with
            # another suffix, so that no list shows it before it is checked.
            self._file = tempfile.NamedTemporaryFile(dir=store.folder, suffix=".part")  # noqa: SIM115 - closed by `close`
        except OSError as error:
            refused = _unwritten(store, error)
            raise refused from error

    def write(self, data: bytes) -> None:
        """Write the next bytes of the file.

        Raises:
            RecordingFileError: The disk is full, or broken.
        """
        try:
            self._file.write(data)
        except OSError as error:
            refused = _unwritten(self._store, error)
            raise refused from error

    def finish(self, pause: Callable[[], None] = lambda: None) -> RecordingInfo:
        """Check the file, list it as a recording, and return its description.

        Args:
            pause: Called between short pieces of work.

        Raises:
            RecordingRefusedError: The file is not a complete recording of a station.
            RecordingFileError: The file cannot be written.
        """
        path = Path(self._file.name)
        try:
            self._file.flush()
            found = recover_file(path, pause)
            RecordingTable(path, pause=pause)
        except (*DAMAGE, RecordingFileError) as error:
            refusal = _refused("no MCAP file of a station")
            raise refusal from error
        if found.is_changed:
            why = "not whole: its end is missing, or some of its bytes are damaged"
            refusal = _refused(why)
            raise refusal
        if not found.cycles:
            refusal = _refused("no recording of a station: it has no cycles")
            raise refusal
        info, file = self._store.begin(partial(_Linked, path), self._name)
        file.close()
        began = datetime.fromtimestamp(found.began // 10**9, UTC)
        info = replace(
            info,
            state=STOPPED,
            is_uploaded=True,
            started_at=began.isoformat(timespec="seconds"),
            first_cycle=found.first_cycle,
            last_cycle=found.last_cycle,
            cycles=found.cycles,
            lost=found.lost_cycles,
            duration=found.duration,
            size=path.stat().st_size,
        )
        failure = self._store.keep(info)
        if failure is not None:
            refused = _unwritten(self._store, failure)
            raise refused from failure
        return info

    def close(self) -> None:
        """Delete the file, unless it has become a recording."""
        self._file.close()


class _Linked:
    """A second name (hard link) of a file; it stays if the first name is deleted."""

    def __init__(self, source: Path, target: Path) -> None:
        target.hardlink_to(source)

    def close(self) -> None:
        """Do nothing, because no file is open."""


def _refused(why: str) -> RecordingRefusedError:
    return RecordingRefusedError(
        f"The file was not kept: it is {why}.",
        remedy="Choose an .mcap file that a station has written; `station "
        "recover_file` mends one that is cut off.",
    )


def _unwritten(store: RecordStore, error: OSError) -> RecordingFileError:
    return RecordingFileError(
        f"Nothing can be kept in {store.folder}: {error}.",
        remedy="Make room, or configure another folder.",
    )
