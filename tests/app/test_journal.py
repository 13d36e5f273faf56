"""The event log of a running station."""

import pytest

from station.api.app import Kept, create_app
from station.api.auth import Authenticator
from station.app.journal import Journal
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
