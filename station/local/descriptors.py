"""Open files of this process: their limit, and a wait until one can be read.

Connections count as files. Without a free descriptor a server accepts none, and so no
stop.
"""

import resource
import select
from collections.abc import Sequence

ENOUGH = 512
"""Number of open files that a station with all its connections and streams needs."""
LEAST = 128
"""With a lower limit than this a crowd of clients can occupy every connection."""


def open_more_files() -> None:
    """Raise the limit of this process to `ENOUGH`, or as far as the user may raise it.

    The soft limit protects programs that do not watch how many files they have open;
    this one does.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY:
        return
    wanted = ENOUGH if hard == resource.RLIM_INFINITY else min(ENOUGH, hard)
    if soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def most_files() -> int | None:
    """Return the hard limit on the open files of this process; None without one."""
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    return None if hard == resource.RLIM_INFINITY else hard


def shortage() -> str | None:
    """Return a warning of too few files with its remedy; None if there are enough."""
    most = most_files()
    if most is None or most >= LEAST:
        return None
    return (
        f"The process may open {most} files only. A crowd of clients can then keep a "
        f"stop waiting for seconds. `ulimit -n {ENOUGH}` before the start allows more."
    )


def wait_until_readable(
    descriptors: Sequence[int], timeout: float | None = None
) -> bool:
    """Wait until one of some descriptors can be read, or is closed at the other end.

    `select.select` refuses descriptors from 1024 on, which a process that may open more
    files reaches with as many clients.

    Args:
        descriptors: Sockets or pipes.
        timeout: How long to wait at most [s]; 0 looks once, None waits for ever.

    Returns:
        Whether one of them can be read.
    """
    waiting = select.poll()
    for descriptor in descriptors:
        waiting.register(descriptor, select.POLLIN)
    return bool(waiting.poll(None if timeout is None else 1e3 * timeout))
