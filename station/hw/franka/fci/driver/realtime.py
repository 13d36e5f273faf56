"""Whether the control thread may command a real arm.

Source: libfranka@0.9.2 src/control_loop.cpp, ControlLoop; src/control_tools.cpp.
"""

import os
from pathlib import Path

_KERNEL = Path("/sys/kernel/realtime")
_REMEDY = (
    "allow SCHED_FIFO and boot a real-time kernel, or set realtime_config: ignore (see "
    "docs/real_arm.md)"
)


def realtime_problem(thread: int, kernel: Path = _KERNEL) -> str | None:
    """Return why a thread is not real-time enough for an arm, and what to do.

    None if it is.

    Args:
        thread: The thread's number in the operating system.
        kernel: Where a real-time kernel says that it is one.
    """
    try:
        scheduler = os.sched_getscheduler(thread)
    except (AttributeError, OSError):
        return f"libfranka: unable to set realtime scheduling; {_REMEDY}"
    if scheduler != os.SCHED_FIFO:
        return (
            "libfranka: unable to set realtime scheduling: SCHED_FIFO is not granted; "
            f"{_REMEDY}"
        )
    try:
        is_realtime = kernel.read_text("ascii").strip() == "1"
    except OSError:
        is_realtime = False
    if not is_realtime:
        return (
            f"libfranka: Running kernel does not have realtime capabilities; {_REMEDY}"
        )
    return None
