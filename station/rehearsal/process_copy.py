"""Run a function in a copy of this process, and return its result.

The copy (`fork`) has the same memory, so a station in it goes on from the present cycle
with the same robot, controllers and commands, bit for bit. The copy cannot affect the
original: it gets its own shared memory, and keeps no socket or file.

A copy has only the calling thread. A lock that another thread held at the moment of the
copy stays locked in it for ever, so a copy that makes no progress is ended and
replaced.
"""

import ctypes
import gc
import os
import pickle
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

from station.core.errors import RehearsalError, trace_of_fault
from station.local.descriptors import wait_until_readable

ResultT = TypeVar("ResultT")

STUCK_AFTER = 2.0
"""Time without a sign of progress after which a copy is ended [s]. A piece of work
takes milliseconds, but a busy machine may not run the copy for a while."""
ATTEMPTS = 4
"""Most copies that are made, one after the other."""
_PROGRESS = b"."
_RESULT = b"="
_FAILURE = b"!"
# Constants from the headers of Linux and glibc, for two calls that Python lacks.
_PR_SET_PDEATHSIG = 1
_PROT_READ_WRITE = 0x1 | 0x2
_MAP_PRIVATE_FIXED_ANONYMOUS = 0x02 | 0x10 | 0x20
_MAP_FAILED = ctypes.c_void_p(-1).value


def run_in_copy(
    work: Callable[[Callable[[], None]], ResultT | None],
    wait: Callable[[], None] = lambda: None,
    patience: float = STUCK_AFTER,
) -> ResultT:
    """Call `work` in a copy of this process, and return its result.

    Args:
        work: Called in the copy, with a function that it calls after each piece of
            work. Its result is pickled; None means that the copy was made at an
            unsuitable moment.
        wait: Called before each copy is made; waits for a good moment.
        patience: Time without a sign of progress after which a copy is ended [s].

    Raises:
        RehearsalError: This system cannot copy a process, or no copy has returned a
            result.
    """
    if sys.platform != "linux":
        raise RehearsalError(
            f"This system ({sys.platform}) cannot copy a process that has threads.",
            remedy="Rehearse on Linux.",
        )
    why = "no copy was made"
    for _ in range(ATTEMPTS):
        wait()
        kind, content = _run_once(work, patience)
        if kind == _FAILURE:
            trace = content.decode()
            raise RehearsalError(
                f"The rehearsal failed: {trace.rstrip().rpartition(chr(10))[2]}",
                remedy="Report it: the details have the traceback.",
                details={"traceback": trace},
            )
        if kind == _RESULT:
            result: ResultT | None = pickle.loads(content)
            if result is not None:
                return result
            why = "each was made in the middle of a cycle"
        else:
            why = "the last one made no progress"
    raise RehearsalError(
        f"None of {ATTEMPTS} copies of the station came to a result: {why}.",
        remedy="Try again; the machine may be overloaded.",
    )


def _run_once(
    work: Callable[[Callable[[], None]], object], patience: float
) -> tuple[bytes, bytes]:
    """Make one copy; return how it ended, `_PROGRESS` if stuck, and its answer."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _live_as_copy(work, writing)
    os.close(writing)
    received = bytearray()
    try:
        while wait_until_readable([reading], patience):
            part = os.read(reading, 1 << 20)
            if not part:
                break
            received += part
    finally:
        os.close(reading)
        # The copy has ended, is stuck, or its answer is no longer wanted.
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    answer = bytes(received.lstrip(_PROGRESS))
    # A complete answer ends with a mark; a truncated one counts as no answer.
    if not answer.endswith(_PROGRESS):
        return _PROGRESS, b""
    return answer[:1], answer[1:-1]


def _live_as_copy(work: Callable[[Callable[[], None]], object], writing: int) -> None:
    """Do the work in the copy, write the answer, and exit without any clean-up.

    Everything that would be closed, flushed or joined belongs to the original.
    """
    code = 1
    try:
        try:
            _become_ordinary(writing)
            answer = _RESULT + pickle.dumps(work(lambda: _tell(writing)))
        except BaseException:  # noqa: BLE001 - the boundary: handed to the original
            answer = _FAILURE + trace_of_fault().encode()
        left = memoryview(answer + _PROGRESS)
        while left:
            left = left[os.write(writing, left) :]
        code = 0
    finally:
        os._exit(code)


def _tell(writing: int) -> None:
    os.write(writing, _PROGRESS)


def _become_ordinary(kept: int) -> None:
    """Give up the priority, the files and the shared memory of the original process.

    Args:
        kept: The only file that stays open, besides the standard ones.
    """
    # Lower the priority first: otherwise the copy would delay the station's threads.
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    with suppress(OSError):
        os.setpriority(os.PRIO_PROCESS, 0, max(0, os.getpriority(os.PRIO_PROCESS, 0)))
    library = ctypes.CDLL(None, use_errno=True)
    # The copy must not outlive the thread that waits for it.
    library.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    # A garbage collection would touch, and so copy, every object.
    gc.disable()
    _own_shared_memory(library)
    # A socket ends for its peer only when every process has closed it.
    os.closerange(3, kept)
    os.closerange(kept + 1, os.sysconf("SC_OPEN_MAX"))


def _own_shared_memory(library: ctypes.CDLL) -> None:
    """Replace writable shared memory by memory of this process.

    The watchdog, and programs of libfranka, would otherwise take the copy's values
    for the station's own.

    Raises:
        OSError: The system refuses the mapping.
    """
    library.mmap.restype = ctypes.c_void_p
    library.mmap.argtypes = (
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int,
        ctypes.c_int,
        ctypes.c_int,
        ctypes.c_long,
    )
    with open("/proc/self/maps", encoding="utf-8", errors="replace") as lines:
        shared = [line.split(maxsplit=5) for line in lines if line.split()[1] == "rw-s"]
    for span, *_ in shared:
        first, last = (int(number, 16) for number in span.split("-"))
        content = ctypes.string_at(first, last - first)
        placed = library.mmap(
            first, last - first, _PROT_READ_WRITE, _MAP_PRIVATE_FIXED_ANONYMOUS, -1, 0
        )
        if placed in {None, _MAP_FAILED}:
            raise OSError(ctypes.get_errno(), "A shared page cannot be replaced")
        ctypes.memmove(first, content, last - first)
