"""Verbs `record`, `incidents` and `recover_file`."""

import json
from pathlib import Path

import pytest

from station.app.rerun import Difference, RerunResult
from station.cli.parser import parse
from station.records.recording_table import Choice
from station.wire import Recording


def _recording(**values):
    return Recording.model_validate({
        "identifier": "20261122T091500123-pick",
        "name": "pick",
        "note": "a note",
        "state": "stopped",
        "error": "",
        "started_at": "now",
        "first_cycle": 1,
        "last_cycle": 400,
        "cycles": 400,
        "lost": 0,
        "duration": 0.399,
        "size": 2_500_000,
        **values,
    })


class FakeRecordings:
    """The recordings, or the incidents, of the fake station."""

    def __init__(self):
        self.calls = []
        self.found = _recording()

    def list(self):
        return [self.found]

    def start(self, *words):
        self.calls.append(("start", *words))
        return self.found.model_copy(update={"state": "recording"})

    def stop(self, name):
        self.calls.append(("stop", name))
        if self.found is None:
            raise LookupError("Nothing is being recorded.")
        return self.found

    def delete(self, name):
        self.calls.append(("delete", name))
        return self.found

    def download(self, name, target):
        self.calls.append(("download", name))
        Path(target).write_bytes(b"bytes")
        return Path(target)


@pytest.fixture(autouse=True)
def recordings(station):
    """Give the fake station recordings and incidents."""
    station.recordings, station.incidents = FakeRecordings(), FakeRecordings()
    station.incidents.found = _recording(causes=["The station was stopped: x."])
    return station.recordings


def test_a_recording_is_started_and_stopped(run, recordings):
    started = run("record start pick --note heavy").out
    stopped = run("record stop").out

    assert recordings.calls == [("start", "pick", "heavy"), ("stop", None)]
    assert started.startswith("Recording 20261122T091500123-pick.")
    assert stopped == "20261122T091500123-pick: 400 cycles, 2.5 MB, none lost.\n"


def test_a_recording_that_failed_is_told_with_the_exit_code(run, recordings):
    recordings.found = _recording(state="failed", error="The disk is full.", lost=3)
    outcome = run("record stop x")

    assert outcome.code == 1
    assert "3 lost. The disk is full." in outcome.out


def test_a_stop_while_nothing_is_recorded_is_refused(run, recordings):
    recordings.found = None

    outcome = run("record stop")

    assert outcome.code == 1
    assert "Nothing is being recorded." in outcome.err


def test_recordings_are_listed(run):
    line = run("record list").out.splitlines()[1].split()
    assert line[:4] == ["20261122T091500123-pick", "stopped", "0.4", "s"]
    assert json.loads(run("record list --json").out)[0]["cycles"] == 400


def test_incidents_are_listed_with_their_causes(run):
    assert "The station was stopped: x." in run("incidents list").out


@pytest.mark.parametrize("verb", ["record", "incidents"])
def test_a_file_is_fetched_and_never_overwritten(run, tmp_path, verb):
    target = tmp_path / "x.mcap"
    assert run(f"{verb} get a -o {target}").code == 0
    assert target.read_bytes() == b"bytes"
    again = run(f"{verb} get a -o {target}")
    assert again.code == 2
    assert "already" in again.err


def test_a_table_is_made_of_the_file(run, tmp_path, monkeypatch):
    def export(source, target, form, choice):
        target.write_text(f"{form} of {source.read_bytes()!r}: {choice}")

    monkeypatch.setattr("station.records.recording_table.export", export)
    target = tmp_path / "x.csv"

    chosen = "--channels joint_states commands/effort --joints j --rate 100"
    run(f"record get a -o {target} --format csv {chosen}")

    choice = Choice(("joint_states", "commands/effort"), ("j",), 100.0)
    assert target.read_text() == f"csv of b'bytes': {choice}"


@pytest.mark.parametrize(
    ("chosen", "told"),
    [
        ("--rate 100", "choose of a table"),
        ("--format csv --rate 0", "no number of rows"),
        ("--format csv --rate nan", "no number of rows"),
    ],
)
def test_a_choice_that_makes_no_sense_is_wrong_usage(run, tmp_path, chosen, told):
    found = run(f"record get a -o {tmp_path / 'x'} {chosen}")
    assert found.code == 2
    assert told in found.err


def test_a_recording_is_deleted(run, recordings):
    assert run("record delete a").out == "Deleted 20261122T091500123-pick.\n"
    assert recordings.calls == [("delete", "a")]


@pytest.mark.parametrize(
    "line", ["record get", "record delete", "record rerun", "incidents get", "record x"]
)
def test_missing_words_are_wrong_usage(run, recordings, line):
    assert run(line).code == 2
    assert recordings.calls == []


@pytest.mark.parametrize(
    ("difference", "code", "text"),
    [
        (None, 0, "Equal: 7 cycles"),
        (Difference(3, "j", "position", 1.0, 2.0), 1, "Different from cycle 3 on"),
    ],
)
def test_a_re_run_says_whether_it_is_equal(run, monkeypatch, difference, code, text):
    found = RerunResult(7, difference, ())
    monkeypatch.setattr("station.app.rerun.rerun", lambda _: found)

    outcome = run("record rerun x.mcap")

    assert outcome.code == code
    assert text in outcome.out


def test_what_is_no_recording_is_not_recovered(run, tmp_path):
    path = tmp_path / "x.mcap"
    path.write_bytes(b"nothing")
    outcome = run(f"recover-file {path}")

    assert outcome.code == 1
    assert "is no recording" in outcome.err


def test_the_defaults_are_the_file_itself():
    options = parse(["record", "get", "x"])
    assert (options.action, options.name, options.format, options.output) == (
        "get", "x", "mcap", None,
    )  # fmt: skip


def test_recovery_needs_no_station():
    options = parse(["recover_file", "x.mcap"])
    assert not hasattr(options, "url")
