"""The means by which a Python process keeps its control thread on time.

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
"""Longest wait of the control thread while another thread keeps the interpreter [s]."""
CYCLE_SWITCH_INTERVAL = 5e-3
"""How long a cycle may keep the interpreter while others wait for it [s]: the usual
interval of Python, longer than any cycle but one that hangs."""
FIFO_PRIORITY = 50
"""Priority asked for, as real-time audio and robot drivers do (1 to 99)."""
ROUND_ROBIN_PRIORITY = 1
"""SCHED_RR priority of the other threads, the lowest one. One of them may hold the
interpreter while the control thread waits for it, so a busy machine must not keep it
off the processor (benchmarks/bench_dashboard.py)."""
NICENESS = -10
"""Niceness of the other threads where SCHED_RR is not granted. Linux compares niceness
within a session only: it does not help against a browser started from the desktop."""
GC_THRESHOLDS = (50_000, 20, 50)
"""Thresholds of rare collections: the control loop makes no cycles of references."""


@contextmanager
def realtime_interpreter() -> Iterator[None]:
    """Set the interpreter up for a control thread; put everything back on exit.

    Enter it once all long-lived objects exist: from then on the garbage collector
    leaves them alone. The scheduler favours threads that are started inside, where that
    is permitted.
    """
    thresholds = gc.get_threshold()
    # Collect first: otherwise the garbage of the start would be frozen, too.
    gc.collect()
    gc.freeze()
    gc.set_threshold(*GC_THRESHOLDS)
    try:
        with (
            switch_interval_kept(),
            _policy("SCHED_RR", ROUND_ROBIN_PRIORITY, NICENESS),
        ):
            let_others_in()
            yield
    finally:
        gc.set_threshold(*thresholds)
        gc.unfreeze()


def let_others_in() -> None:
    """Let a waiting thread have the interpreter soon; called before a sleep."""
    sys.setswitchinterval(SWITCH_INTERVAL)


def keep_interpreter() -> None:
    """Keep the interpreter through a cycle; called when the control thread wakes."""
    sys.setswitchinterval(CYCLE_SWITCH_INTERVAL)


@contextmanager
def switch_interval_kept() -> Iterator[None]:
    """Leave the interpreter's switch interval as it was."""
    interval = sys.getswitchinterval()
    try:
        yield
    finally:
        sys.setswitchinterval(interval)


@contextmanager
def ordinary_priority() -> Iterator[None]:
    """Give ordinary priority to the calling thread and the processes that it starts.

    A process inherits the scheduling of the thread that starts it. The priority of the
    station's threads is not meant for a dashboard, a compiler or an experiment.
    """
    with _policy("SCHED_OTHER", 0, max(os.getpriority(os.PRIO_PROCESS, 0), 0)):
        yield


@contextmanager
def _policy(name: str, priority: int, niceness: int) -> Iterator[None]:
    """Schedule the calling thread with this policy as far as that is permitted."""
    before = os.getpriority(os.PRIO_PROCESS, 0)
    with suppress(PermissionError):
        # Ordinary users may not lower it; the station runs all the same.
        os.setpriority(os.PRIO_PROCESS, 0, niceness)
    # macOS has no such policies.
    policy = getattr(os, name, None)
    scheduled = None if policy is None else _scheduling()
    if policy is not None:
        with suppress(PermissionError):
            os.sched_setscheduler(0, policy, os.sched_param(priority))
    try:
        yield
    finally:
        # Only what was changed is set back: setting it needs the permission again.
        if scheduled is not None and scheduled != _scheduling():
            os.sched_setscheduler(0, scheduled[0], os.sched_param(scheduled[1]))
        if os.getpriority(os.PRIO_PROCESS, 0) != before:
            os.setpriority(os.PRIO_PROCESS, 0, before)


def _scheduling() -> tuple[int, int]:
    """Return policy and priority of the calling thread."""
    return os.sched_getscheduler(0), os.sched_getparam(0).sched_priority


def request_realtime_priority() -> str:
    """Ask for SCHED_FIFO for the calling thread; return the granted policy in words."""
    if not hasattr(os, "sched_setscheduler"):
        return "SCHED_OTHER (this system has no SCHED_FIFO)"
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(FIFO_PRIORITY))
    # Refused without the capability, and in containers.
    except OSError as error:
        return f"SCHED_OTHER (SCHED_FIFO was refused: {error.strerror})"
    return f"SCHED_FIFO {FIFO_PRIORITY}"
