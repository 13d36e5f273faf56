"""Run something in a copy of this process, and take its result.

The copy (`fork`) has all memory as it was, so a station in it goes on from the present
cycle with the same robot, controllers and commands, bit for bit. Nothing that it does
reaches the original: shared memory becomes its own, and it has no socket or file.

A copy has the calling thread only. A lock that another thread held at that moment
stays locked in it, so a copy that makes no progress is ended and another one is made.
"""

import ctypes
import gc
import os
import pickle
import select
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

from station.core.errors import RehearsalError
from station.core.faults import trace_of_fault

ResultT = TypeVar("ResultT")

STUCK_AFTER = 2.0
"""A copy that has not said for so long that it makes progress is ended [s]. A piece of
work takes milliseconds; a busy machine may keep the copy off the processor."""
ATTEMPTS = 4
"""Copies that are made at most, one after the other."""
_PROGRESS = b"."
_RESULT = b"="
_FAILURE = b"!"
# From the headers of Linux and glibc, for two calls that Python does not have.
_PR_SET_PDEATHSIG = 1
_PROT_READ_WRITE = 0x1 | 0x2
_MAP_PRIVATE_FIXED_ANONYMOUS = 0x02 | 0x10 | 0x20
_MAP_FAILED = ctypes.c_void_p(-1).value


def run_in_copy(
    work: Callable[[Callable[[], None]], ResultT | None],
    wait: Callable[[], None] = lambda: None,
    patience: float = STUCK_AFTER,
) -> ResultT:
    """Return the result of `work`, done in a copy of this process.

    Args:
        work: Called in the copy, with a function that it calls after each piece of
            work. Its result is pickled; None says that the copy was made at a moment
            that it cannot use.
        wait: Called before each copy is made; waits for a good moment.
        patience: A copy that has not said for so long that it makes progress is ended
            [s].

    Raises:
        RehearsalError: This system cannot copy a process, or no copy has come to a
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
    """Make one copy; return how it ended, `_PROGRESS` if it did not, and its answer."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _live_as_copy(work, writing)
    os.close(writing)
    received = bytearray()
    try:
        while select.select([reading], [], [], patience)[0]:
            part = os.read(reading, 1 << 20)
            if not part:
                break
            received += part
    finally:
        os.close(reading)
        # It has ended, or is stuck, or nobody wants its answer any more.
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    answer = bytes(received.lstrip(_PROGRESS))
    # The answer ends with a mark: one that is cut off counts as none.
    if not answer.endswith(_PROGRESS):
        return _PROGRESS, b""
    return answer[:1], answer[1:-1]


def _live_as_copy(work: Callable[[Callable[[], None]], object], writing: int) -> None:
    """Do the work in the copy, write the answer, and end without any clean-up.

    Whatever waits to be closed, flushed or joined belongs to the original.
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
    """Give up priority, files and shared memory of the original process.

    Args:
        kept: The only file that stays open, besides the standard ones.
    """
    # First: with the priority of the station's threads it would keep them waiting.
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    with suppress(OSError):
        os.setpriority(os.PRIO_PROCESS, 0, max(0, os.getpriority(os.PRIO_PROCESS, 0)))
    library = ctypes.CDLL(None, use_errno=True)
    # It does not outlive the thread that waits for it.
    library.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    # A collection would touch, and so copy, every object there is.
    gc.disable()
    _own_shared_memory(library)
    # Sockets end for their peers when all processes have closed them.
    os.closerange(3, kept)
    os.closerange(kept + 1, os.sysconf("SC_OPEN_MAX"))


def _own_shared_memory(library: ctypes.CDLL) -> None:
    """Put memory of this process in the place of writable shared memory.

    The watchdog, and programs of libfranka, would otherwise take the copy's values
    for the station's own.

    Raises:
        OSError: The system refuses it.
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
