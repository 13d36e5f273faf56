"""What a Python process can do so that its control thread is on time.

The interpreter's switch interval decides how long the control thread waits for a busy
neighbour; a full garbage collection over a large heap takes tens of milliseconds
(benchmarks/bench_interpreter.py). What SCHED_FIFO is worth depends on the machine
(benchmarks/bench_loop_lateness.py).
"""

import gc
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

SWITCH_INTERVAL = 1e-4
"""Longest wait for the interpreter lock behind a busy thread [s]."""
FIFO_PRIORITY = 50
"""Priority asked for, as real-time audio and robot drivers do (1 to 99)."""
NICENESS = -10
"""Niceness of the other threads. One of them may hold the interpreter while the control
thread waits for it, so a busy machine must not keep it off the processor for long."""
GC_THRESHOLDS = (50_000, 20, 50)
"""Collect rarely: the control loop makes no cycles of references."""


@contextmanager
def realtime_interpreter() -> Iterator[None]:
    """Set the interpreter up for a control thread; put everything back on exit.

    Enter it once all long-lived objects exist: they are frozen out of the garbage
    collector's sight. Threads started inside are favoured by the scheduler where that
    is permitted.
    """
    interval, thresholds = sys.getswitchinterval(), gc.get_threshold()
    niceness = os.getpriority(os.PRIO_PROCESS, 0)
    gc.collect()
    gc.freeze()
    gc.set_threshold(*GC_THRESHOLDS)
    sys.setswitchinterval(SWITCH_INTERVAL)
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, NICENESS)
    try:
        yield
    finally:
        sys.setswitchinterval(interval)
        gc.set_threshold(*thresholds)
        gc.unfreeze()
        if os.getpriority(os.PRIO_PROCESS, 0) != niceness:
            os.setpriority(os.PRIO_PROCESS, 0, niceness)


def request_realtime_priority() -> str:
    """Ask for SCHED_FIFO for the calling thread; return what was granted, in words."""
    if not hasattr(os, "sched_setscheduler"):
        return "SCHED_OTHER (this system has no SCHED_FIFO)"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(FIFO_PRIORITY))
    except OSError as error:
        return f"SCHED_OTHER (SCHED_FIFO was refused: {error.strerror})"
    return f"SCHED_FIFO {FIFO_PRIORITY}"
