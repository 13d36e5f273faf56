"""The station's side of its watchdog: started, fed, started again, ended."""

import os
import signal
import time
from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest

from station.app.station_watchdog import WatchdogProcess
from station.app.watchdog.watch import WatchdogSettings
from station.cli.verbs.motion import WatchdogError, stop_through_watchdog
from station.core.loop.heartbeat import LoopLife, Phase
from tests.app.watchdog.bench import OPERATOR, VIEWER
from tests.waiting import PATIENCE, wait_until


@pytest.fixture
def watchdog(tmp_path):
    """Return a watchdog of this process that sees a loop which woke up just now."""
    process = WatchdogProcess()
    process.heartbeat.beats[0] = time.monotonic()
    process.heartbeat.life = LoopLife.RUNNING
    process.heartbeat.phase = Phase.RUNNING
    process.start(
        WatchdogSettings(
            os.getpid(), OPERATOR, VIEWER, str(tmp_path), notice_after=60.0
        )
    )
    yield process
    process.finish(20.0)


def ready(url):
    connection = HTTPConnection(urlsplit(url).netloc, timeout=PATIENCE)
    connection.request("GET", "/ready")
    status = connection.getresponse().status
    connection.close()
    return status


def test_it_answers_from_the_first_moment_on(watchdog):
    assert ready(watchdog.url) == 200


def test_a_stop_reaches_the_page_of_the_station(watchdog):
    stopped = stop_through_watchdog(watchdog.url, VIEWER, "smoke")

    assert not stopped.carried_out
    assert watchdog.heartbeat.is_stop_asked
    assert "smoke" in watchdog.heartbeat.stop_reason()


def test_a_wrong_token_is_refused(watchdog):
    with pytest.raises(WatchdogError, match="refuses: A token"):
        stop_through_watchdog(watchdog.url, "wrong", "smoke")


def test_it_is_started_again_at_the_same_address(watchdog):
    assert watchdog.start_again_if_ended() is None
    first = watchdog.pid
    os.kill(first, signal.SIGKILL)

    assert wait_until(watchdog.start_again_if_ended) == -signal.SIGKILL
    assert watchdog.pid != first
    assert ready(watchdog.url) == 200


def test_a_watchdog_that_does_not_read_keeps_nobody_waiting(watchdog):
    os.kill(watchdog.pid, signal.SIGSTOP)

    for number in range(2000):
        watchdog.tell({"cycle": number, "text": "x" * 3000})
    os.kill(watchdog.pid, signal.SIGCONT)

    assert ready(watchdog.url) == 200


def test_a_suspended_watchdog_looks_no_more_until_it_goes_on(watchdog):
    assert watchdog.age(time.monotonic()) < 0.0  # it starts
    assert ready(watchdog.url) == 200
    os.kill(watchdog.pid, signal.SIGSTOP)
    assert wait_until(lambda: watchdog.age(time.monotonic()) > 0.5)
    os.kill(watchdog.pid, signal.SIGCONT)
    assert wait_until(lambda: watchdog.age(time.monotonic()) < 0.3)


def test_a_long_status_is_cut_off(watchdog):
    watchdog.tell({"running": "x" * 100_000})

    assert ready(watchdog.url) == 200


def test_nobody_answers_after_the_end():
    process = WatchdogProcess()
    process.finish(1.0)

    with pytest.raises(WatchdogError, match="does not answer"):
        stop_through_watchdog(process.url, VIEWER, "smoke")
