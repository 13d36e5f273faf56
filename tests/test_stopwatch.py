"""The stopwatch counts what a process sleeps, and not what others keep from it."""

import os
import shlex
import signal
import subprocess
import sys
import time

import pytest

from tests.stopwatch import Stopwatch

WORK = "import time\nwhile time.process_time() < {}: pass"


def run_pinned(code):
    """Start Python, by a shell that waits for it, on a processor that all share."""
    processor = min(os.sched_getaffinity(0))
    command = shlex.join([sys.executable, "-S", "-c", code])
    return subprocess.Popen(
        ["/bin/sh", "-c", f"{command}; exit"],
        start_new_session=True,
        preexec_fn=lambda: os.sched_setaffinity(0, [processor]),
    )


def test_sleep_is_counted():
    process = run_pinned("import time; time.sleep(0.5)")
    with Stopwatch(process.pid) as watch:
        process.wait()

    assert watch.seconds > 0.45


@pytest.mark.alone
def test_waiting_for_a_processor_is_not_counted():
    others = [run_pinned(WORK.format(60.0)) for _ in range(3)]
    try:
        began = time.monotonic()
        process = run_pinned(WORK.format(0.5))
        with Stopwatch(process.pid) as watch:
            process.wait()
        duration = time.monotonic() - began
    finally:
        for other in others:
            os.killpg(other.pid, signal.SIGKILL)
            other.wait()

    assert duration > 1.5
    assert watch.seconds < duration / 2
