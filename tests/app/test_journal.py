"""The event log of a running station."""

import pytest

from station.api.app import Kept, create_app
from station.api.auth import Authenticator
from station.app.journal import Journal
from station.events import EventKind
from station.records.record_store import Quota, RecordStore
from station.records.recorder import Recorder
from station.records.recording_reader import read_messages
from tests.api.spring import make_station


@pytest.fixture(autouse=True)
def own_state(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))


def run(warnings):
    station = make_station()
    station.loop.step()
    with Journal(station, warnings.append) as journal:
        journal.start(create_app(station, Authenticator(), kept=Kept(journal.log)))
        station.stop("for the test")
    return journal


def test_start_and_end_and_what_lies_between_are_kept_over_runs():
    warnings = []
    run(warnings)
    log = run(warnings).log

    results = [event.result for event in log.since()]
    assert results.count("started") == results.count("ended") == 2
    assert results.count("stopped") == 2
    assert results[-1] == "ended"
    assert warnings == []


def test_without_a_directory_it_goes_on_in_memory(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no directory")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))
    warnings = []

    journal = run(warnings)

    assert "in memory alone" in warnings[0]
    assert journal.log.since()


def test_recordings_have_the_events_and_events_tell_of_recordings(tmp_path):
    station = make_station()
    recorder = Recorder(station, RecordStore(tmp_path / "kept", Quota()))
    with Journal(station, []) as journal:
        kept = Kept(journal.log, recorder)
        journal.start(create_app(station, Authenticator(), kept=kept))
        identifier = recorder.start("walk").identifier
        station.loop.step(5)
        journal.log.record(EventKind.STOP, "The stop is engaged.")
        recorder.drain()
        recorder.stop()
        told = [
            (event.result, event.what)
            for event in journal.log.since(kinds=[EventKind.RECORDING])
        ]
    recorder.close()

    messages = read_messages(recorder.store.file(identifier), ["/events"])
    assert "The stop is engaged." in [message["text"] for _, message in messages]
    assert told == [("recording", identifier), ("stopped", identifier)]
