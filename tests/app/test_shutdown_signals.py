"""The first signal ends the station in order, the second at once."""

import os
import signal
import subprocess
import sys

import pytest

from station.app.shutdown_signals import ShutdownSignals
from tests.waiting import PATIENCE

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


def nothing() -> None:
    """Do nothing."""


@pytest.mark.parametrize("number", SIGNALS)
def test_signal_before_the_first_wait_interrupts_the_start(number):
    with ShutdownSignals(nothing), pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", SIGNALS)
def test_signal_ends_the_wait(number):
    with ShutdownSignals(nothing) as signals:
        assert not signals.wait(0.0)
        os.kill(os.getpid(), number)
        assert signals.wait(PATIENCE)


def test_a_wait_ends_in_time_whatever_other_signals_come():
    program = (
        "import signal, time\n"
        "from station.app.shutdown_signals import ShutdownSignals\n"
        "signal.signal(signal.SIGALRM, lambda *_: time.sleep(0.1))\n"
        "with ShutdownSignals(print) as signals:\n"
        "    signal.setitimer(signal.ITIMER_REAL, 0.01)\n"
        "    print(signals.wait(0.05))\n"
    )

    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, timeout=PATIENCE
    )

    assert ended.stdout == b"False\n"


def test_handlers_are_put_back():
    before = [signal.getsignal(number) for number in SIGNALS]

    with ShutdownSignals(nothing):
        pass

    assert [signal.getsignal(number) for number in SIGNALS] == before


def test_second_signal_ends_the_process_at_once():
    program = (
        "import os, signal, sys\n"
        "from station.app.shutdown_signals import ShutdownSignals\n"
        "def clean(): os.write(1, b'killed the rest')\n"
        "with ShutdownSignals(clean) as signals:\n"
        "    signals.wait(0.0)\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    signals.wait(1.0)\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    os.write(1, b'lived on')\n"
    )

    ended = subprocess.run([sys.executable, "-c", program], capture_output=True)

    assert ended.returncode == 128 + signal.SIGINT
    assert ended.stdout == b"killed the rest"
    assert ended.stderr == b""
