"""Limit of the files, and so of the connections, of this process.

Without a free file descriptor a server accepts no connection, and so no stop.
"""

import resource

ENOUGH = 512
"""What a station with all its connections and streams needs."""
LEAST = 128
"""With less than this a crowd of clients takes every connection that there is."""


def open_more_files() -> None:
    """Raise the limit of this process to a sufficient one, as far as its user may.

    A soft limit is for programs that do not look how many files they have open.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY:
        return
    wanted = ENOUGH if hard == resource.RLIM_INFINITY else min(ENOUGH, hard)
    if soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def most_files() -> int | None:
    """Return the most files this process may be allowed; None without a limit."""
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
