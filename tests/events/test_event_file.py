"""Events on disk."""

import json
import sqlite3

import pytest

from station.events.event_file import MAX_DETAILS, EventFile, written_details
from station.reports import Event, EventKind, Severity


def event(number, kind=EventKind.STOP, severity=Severity.INFO, time=1000.0):
    return Event(
        number, time, 1.5, 1500, kind, severity, "ada", "127.0.0.1", details={"a": 1}
    )


@pytest.fixture
def file(tmp_path):
    file = EventFile(tmp_path / "events.sqlite")
    yield file
    file.close()


def test_events_are_read_as_they_were_written(file):
    events = [event(1), event(2, EventKind.FAULT, Severity.ERROR)]
    file.append(events)

    assert file.read(0, 10) == events
    assert file.newest_id() == 2


def test_events_are_chosen_by_number_kind_and_severity(file):
    file.append([event(1), event(2, EventKind.FAULT, Severity.ERROR), event(3)])

    assert [e.id for e in file.read(1, 10)] == [2, 3]
    assert [e.id for e in file.read(0, 2)] == [1, 2]
    assert [e.id for e in file.read(0, 10, [EventKind.STOP])] == [1, 3]
    assert [e.id for e in file.read(0, 10, (), Severity.WARNING)] == [2]


def test_kinds_that_only_a_newer_station_knows_are_passed_over(file):
    file.append([event(1), event(2), event(3)])
    with sqlite3.connect(file.path) as newer:
        newer.execute("UPDATE events SET kind = 'of tomorrow' WHERE id = 2")
    newer.close()

    assert [e.id for e in file.read(0, 10)] == [1, 3]
    assert [e.id for e in file.read_newest(10, 10)] == [1, 3]


def test_writing_the_same_twice_changes_nothing(file):
    file.append([event(1)])
    file.append([event(1), event(2)])

    assert [e.id for e in file.read(0, 10)] == [1, 2]


def test_too_many_and_too_old_events_are_deleted(file):
    file.append([event(1, time=10.0), *(event(n) for n in range(2, 11))])

    file.prune(most=5, oldest=0.0)
    assert [e.id for e in file.read(0, 10)] == [6, 7, 8, 9, 10]
    file.append([event(11, time=2000.0)])
    file.prune(most=100, oldest=1500.0)
    assert [e.id for e in file.read(0, 10)] == [11]


def test_a_file_of_something_else_is_refused(tmp_path):
    path = tmp_path / "events.sqlite"
    path.write_bytes(b"no database" * 1000)

    with pytest.raises(sqlite3.DatabaseError):
        EventFile(path)


def test_severities_have_an_order():
    assert Severity.INFO.rank < Severity.WARNING.rank < Severity.ERROR.rank


def test_details_become_json_whatever_they_are():
    details = {"kind": EventKind.STOP, "x": float("nan"), "set": {1}, "p": object}

    found = json.loads(written_details(details))

    assert found == {"kind": "stop", "x": None, "set": [1], "p": str(object)}


def test_long_details_are_shortened():
    text = written_details({"traceback": "x" * 10 * MAX_DETAILS})

    assert len(text) <= MAX_DETAILS
    assert list(json.loads(text)) == ["shortened"]
