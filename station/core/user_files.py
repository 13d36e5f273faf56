"""Folders of the user that several stations share: private, locked, read with care.

Two stations of one user have the same folders. A station locks what it changes. The
lock is one of the operating system, which releases it when the station is killed.
"""

import fcntl
import os
import stat
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

APPLICATION = "control-station"
"""The folder in the user's data directory that holds all folders of the station."""
LONGEST_WAIT = 2.0
"""Longest wait for another station that changes the same folder [s]."""
_LOOK = 0.01


def user_folder(name: str) -> Path:
    """Return the folder of this user's files.

    Args:
        name: Name of the folder among the data of the control station.
    """
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(data) / APPLICATION / name


def make_private_folder(folder: Path) -> None:
    """Make a folder and its missing parents, with access for the user only.

    The control station's own folder is closed to others even if it was open before; a
    folder that the user made elsewhere stays as open as it is.

    Raises:
        OSError: The folder cannot be made.
    """
    missing = []
    for one in (folder, *folder.parents):
        if one.is_dir():
            break
        missing.append(one)
    for one in reversed(missing):
        # `parents=True` would make those above readable by everybody.
        one.mkdir(mode=0o700, exist_ok=True)
    own = next((p for p in (folder, *folder.parents) if p.name == APPLICATION), None)
    for one in () if own is None else {own, folder}:
        info = one.stat()
        if info.st_uid == os.getuid() and stat.S_IMODE(info.st_mode) & 0o077:
            one.chmod(0o700)


def open_regular(path: Path, flags: int = os.O_RDONLY) -> int:
    """Open a regular file; refuse a pipe or a device, which may block without end.

    Args:
        path: The file.
        flags: Flags of `os.open`.

    Returns:
        The descriptor.

    Raises:
        OSError: The file is not a regular file, or cannot be opened.
    """
    # Open without waiting: the kind of a file can be checked only once it is open.
    descriptor = os.open(path, flags | os.O_NONBLOCK | os.O_CLOEXEC, 0o600)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(f"{path.name} is no regular file")
    return descriptor


def read_regular(path: Path, most: int) -> str:
    """Return the text of a regular file.

    Args:
        path: The file.
        most: Most bytes that are read.

    Raises:
        OSError: The file is not a regular file, is larger, or cannot be read.
        UnicodeDecodeError: The file is not text.
    """
    with os.fdopen(open_regular(path), "rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(f"it is larger than {most} bytes")
    return data.decode("utf-8")


def try_lock(descriptor: int) -> bool:
    """Lock an open file for its descriptor; return False if another one has the lock.

    On a file system without locks this returns True: no station can take a lock there.
    """
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def is_locked(path: Path) -> bool:
    """Return whether a process writes a file now; False when there is none."""
    try:
        descriptor = open_regular(path)
    except OSError:
        return False
    try:
        # A shared lock, so that two readers do not take one another for the writer.
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    finally:
        os.close(descriptor)
    return False


@contextmanager
def changing(
    folder: Path,
    now: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Iterator[None]:
    """Keep other threads and stations from changing a folder in the body of a `with`.

    Args:
        folder: The folder; it is made if it is missing.
        now: Monotonic clock [s].
        sleep: Function that waits a time [s].

    Raises:
        OSError: The folder cannot be used.
        TimeoutError: Another process keeps the folder locked for longer than
            `LONGEST_WAIT`; this error is an `OSError`, too.
    """
    make_private_folder(folder)
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        deadline = now() + LONGEST_WAIT
        while not try_lock(descriptor):
            if now() >= deadline:
                raise TimeoutError(f"another station changes {folder}")
            sleep(_LOOK)
        yield
    finally:
        os.close(descriptor)
