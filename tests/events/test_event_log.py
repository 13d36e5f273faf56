"""The event log: never waits, keeps events on disk, tells what it could not keep."""

import logging
import os
import signal
import sqlite3
import subprocess
import sys
import threading

import pytest

from station.events import event_log
from station.events.event_file import EventFile, Origin
from station.events.event_log import IN_MEMORY, EventLog
from station.reports import EventKind, Severity
from tests.waiting import PATIENCE

KIND = EventKind.REQUEST


@pytest.fixture
def path(tmp_path):
    return tmp_path / "state" / "events.sqlite"


@pytest.fixture
def log(path):
    log = EventLog(path, boot_id="b", station_time=lambda: (2.5, 2500))
    yield log
    log.close()


def test_an_event_says_when_who_and_where(log):
    event = log.record(
        KIND, "Did it.", what="POST /x", result="200", origin=Origin("ada", "::1", "r")
    )

    assert (event.id, event.stamp, event.cycle, event.boot_id) == (1, 2.5, 2500, "b")
    assert (event.who, event.where, event.request_id) == ("ada", "::1", "r")
    assert log.since() == [event]


def test_events_outlive_the_log(path, log):
    log.record(KIND, "one")
    log.close()

    with_next = EventLog(path)
    event = with_next.record(KIND, "two")
    with_next.close()

    assert event.id == 2
    assert [e.text for e in with_next.since()] == ["one", "two"]


def test_older_events_come_from_disk(log):
    for number in range(IN_MEMORY + 50):
        log.record(KIND, str(number))
    log.close()

    assert not log.is_in_memory(0)
    assert log.is_in_memory(50)
    assert [e.text for e in log.since(0, limit=3)] == ["0", "1", "2"]
    assert [e.id for e in log.since(0, limit=10_000)] == list(range(1, IN_MEMORY + 51))


def test_events_are_chosen_by_kind_and_severity():
    log = EventLog()
    log.record(EventKind.STOP, "s", severity=Severity.WARNING)
    log.record(KIND, "r")

    assert [e.text for e in log.since(kinds=[KIND])] == ["r"]
    assert [e.text for e in log.since(severity=Severity.WARNING)] == ["s"]
    assert [e.text for e in log.newest(1)] == ["r"]


def test_a_log_without_a_file_keeps_the_newest():
    log = EventLog()
    for number in range(IN_MEMORY + 5):
        log.record(KIND, str(number))

    assert log.since(0, limit=1)[0].text == "5"
    assert log.state().lost == 0


def test_listeners_hear_every_event_in_order_until_they_end():
    log, heard = EventLog(), []
    end = log.listen(heard.append)

    events = [log.record(KIND, str(number)) for number in range(3)]
    end()
    log.record(KIND, "later")

    assert heard == events


def test_a_listener_that_raises_is_called_no_more(caplog):
    log, heard = EventLog(), []

    def broken(event):
        heard.append(event)
        raise RuntimeError

    log.listen(broken)
    with caplog.at_level(logging.ERROR):
        log.record(KIND, "one")
        log.record(KIND, "two")

    assert len(heard) == 1
    assert "hears no more" in caplog.text


def test_a_failed_write_is_told_and_made_up_for(path, monkeypatch, caplog):
    monkeypatch.setattr(event_log, "RETRY_PERIOD", 0.001)
    append, broken = EventFile.append, [True]

    def full(self, events):
        if broken:
            raise sqlite3.OperationalError("database or disk is full")
        append(self, events)

    monkeypatch.setattr(EventFile, "append", full)
    log = EventLog(path)
    failed, written = _waiter(log, "not written"), _waiter(log, "written")
    log.record(KIND, "one")
    failed()
    state = log.state()
    assert "disk is full" in state.failure
    assert state.pending >= 1
    broken.clear()
    written()
    log.close()

    assert log.state().failure is None
    with_disk = EventFile(path)
    assert with_disk.read(0, 10)[0].text == "one"
    with_disk.close()
    assert "cannot be written" in caplog.text


def _waiter(log, result):
    """Return a function that returns once an event of that result has come."""
    come = threading.Event()
    log.listen(lambda event: come.set() if event.result == result else None)
    return lambda: come.wait(PATIENCE) or pytest.fail(f"no event {result!r}")


def test_what_never_reaches_the_disk_is_counted(path, monkeypatch):
    def full(*_):
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr(EventFile, "append", full)
    monkeypatch.setattr(event_log, "MAX_PENDING", 10)
    log = EventLog(path)
    for number in range(30):
        log.record(KIND, str(number))
    log.close()

    # With the event that tells of the failure, 31 or 30 if it came after the close.
    assert log.state().lost >= 20


def test_a_file_that_cannot_be_opened_is_told(tmp_path, caplog):
    (tmp_path / "file").write_text("no folder")
    log = EventLog(tmp_path / "file" / "events.sqlite")
    log.record(KIND, "one")

    assert log.state().failure is not None
    assert log.state().lost == 1
    assert [e.text for e in log.since()] == ["one"]
    assert "in memory alone" in caplog.text


def test_a_damaged_file_is_moved_aside(path, caplog):
    path.parent.mkdir()
    path.write_bytes(b"no database" * 1000)
    log = EventLog(path)
    log.record(KIND, "one")
    log.close()

    assert log.state().failure is None
    assert path.with_name("events.sqlite.damaged").exists()
    assert "is damaged" in caplog.text


def test_events_survive_kill_9(path):
    script = (
        "import os, signal, sys, time; from pathlib import Path\n"
        "from station.events import EventKind, EventLog\n"
        "log = EventLog(Path(sys.argv[1]))\n"
        "for n in range(100): log.record(EventKind.REQUEST, str(n))\n"
        "while log.state().pending: time.sleep(0.001)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(path)], check=False, env=os.environ
    )

    assert done.returncode == -signal.SIGKILL
    file = EventFile(path)
    assert [e.text for e in file.read(0, 200)] == [str(n) for n in range(100)]
    file.close()
