"""One file per experiment, whole after anything."""

import os
import signal
import sqlite3
import subprocess
import sys
import textwrap
from dataclasses import replace

import pytest

from station.trials.errors import ExperimentError, ExperimentNotFoundError
from station.trials.results import (
    Results,
    default_folder,
    file_of,
    is_written,
    name_of_now,
    names,
)
from station.trials.trial import TrialResult


def result_of(trial, **metrics):
    return TrialResult(trial.hash, "done", None, metrics, 0.1, "here:1")


@pytest.fixture
def results(tmp_path, panda):
    with Results.create(tmp_path / "one.sqlite", "sweep", panda, {"seed": 1}) as opened:
        yield opened


def test_rows_are_there_as_soon_as_they_are_added(results, step):
    heavy = step.with_parameters({"load": 1.0}, seed=2)
    results.add(step, result_of(step, rms_error=0.1))
    results.add(heavy, result_of(heavy, rms_error=0.2))

    with Results.open(results.path) as other:
        rows = other.rows()
        assert [row.number for row in rows] == [1, 2]
        assert (rows[1].parameters, rows[1].seed) == ({"load": 1.0}, 2)
        assert rows[1].result == result_of(heavy, rms_error=0.2)
        assert other.trial(heavy.hash[:6]).hash == heavy.hash
        assert other.find("no such hash") is None


def test_trial_counts_once(results, step):
    assert results.add(step, result_of(step, rms_error=0.1))

    assert not results.add(step, result_of(step, rms_error=0.5))
    assert [row.result.metrics for row in results.rows()] == [{"rms_error": 0.1}]


def test_recording_comes_back(results, world, step):
    trace = world.record(step)[1]

    results.keep_recording(step.hash, trace)

    assert results.recordings()[step.hash].to_bytes() == trace.to_bytes()


def test_same_experiment_goes_on_and_another_is_refused(results, panda, step):
    results.add(step, result_of(step))

    with Results.create(results.path, "sweep", panda, {"seed": 1}) as again:
        assert again.count() == 1
    with pytest.raises(ExperimentError, match="is another one; it differs in seed"):
        Results.create(results.path, "sweep", panda, {"seed": 2})


def test_names_and_missing_experiments(results, tmp_path):
    assert names(tmp_path) == ["one"]
    assert file_of("one", tmp_path) == results.path
    assert default_folder().name == "experiments"
    with pytest.raises(ExperimentNotFoundError, match="no experiment 'ono'") as caught:
        Results.open(file_of("ono", tmp_path))
    assert "one" in caught.value.remedy
    with pytest.raises(ExperimentNotFoundError, match="is no name of an experiment"):
        file_of("../one", tmp_path)
    with pytest.raises(ExperimentNotFoundError, match="has no trial 'abc'"):
        results.trial("abc")


def test_file_of_something_else_is_refused(tmp_path):
    (tmp_path / "two.sqlite").write_text("no database")

    with pytest.raises(ExperimentError, match="cannot be used"):
        Results.open(tmp_path / "two.sqlite")


@pytest.mark.slow
def test_file_is_whole_after_kill_9(tmp_path):
    program = textwrap.dedent(
        """
        import sys
        from pathlib import Path
        from station.trials.results import Results
        from station.trials.trial import Script
        from station.trials.trial import Setup
        from station.trials.trial import Trial, TrialResult

        setup = Setup.load()
        script = Script(controller="arm", duration=1.0)
        with Results.create(Path(sys.argv[1]), "sweep", setup, {}) as results:
            for number in range(10**6):
                trial = Trial(setup, script, {"load": number * 1e-5})
                metrics = {"energy": float(number)}
                result = TrialResult(trial.hash, "done", None, metrics, 0, "")
                results.add(trial, result)
                if number == 20:
                    print("begun", flush=True)
        """
    )
    path = tmp_path / "killed.sqlite"
    command = [sys.executable, "-c", program, path]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    with process:
        assert process.stdout.readline() == "begun\n"
        os.kill(process.pid, signal.SIGKILL)

    with Results.open(path) as results:
        rows = results.rows()
        assert [row.result.metrics["energy"] for row in rows] == list(range(len(rows)))
        assert len(rows) > 20
    with sqlite3.connect(path) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)


def test_a_full_disk_is_told_and_leaves_the_file_whole(tmp_path, step):
    """The file may not grow any more, as on a disk that is full."""
    path = tmp_path / "x.sqlite"
    reason = "because " * 5_000
    with Results.create(path, "sweep", step.setup, {}) as results:
        connection = results._connection
        (pages,) = connection.execute("PRAGMA page_count").fetchone()
        connection.execute(f"PRAGMA max_page_count = {pages + 2}")
        small = TrialResult(step.hash, "done", None, {}, 0.1, "w")
        results.add(step, small)
        other = step.with_parameters({"load": 1.0})
        large = TrialResult(other.hash, "failed", reason, {}, 0.1, "w")

        with pytest.raises(ExperimentError, match="disk is full"):
            results.add(other, large)

    with Results.open(path) as results:
        assert [row.result for row in results.rows()] == [small]


def test_experiments_of_one_second_have_different_names(tmp_path):
    found = {name_of_now("sweep") for _ in range(50)}

    assert len(found) > 1
    assert all(file_of(name, tmp_path).stem == name for name in found)
    assert all(name.startswith("sweep-20") for name in found)


def test_trials_that_ended_together_are_kept_together_or_not_at_all(results, step):
    heavy = step.with_parameters({"load": 1.0})
    results.add(step, result_of(step))

    assert results.add_all([
        (step, result_of(step)),
        (heavy, result_of(heavy)),
    ]) == [False, True]

    other = step.with_parameters({"load": 2.0})
    broken = replace(result_of(heavy), seconds=object())
    with pytest.raises(ExperimentError, match="Nothing more can be kept"):
        results.add_all([(other, result_of(other)), (heavy, broken)])
    assert results.find(other.hash) is None


def test_an_experiment_that_runs_is_neither_run_again_nor_deleted(results, panda):
    with (
        Results.create(results.path, "sweep", panda, {"seed": 1}) as again,
        results.running(),
    ):
        assert is_written(results.path)
        with pytest.raises(ExperimentError, match="runs in another process"):
            again.delete()
        with pytest.raises(ExperimentError, match="runs in another process"):
            again.running().__enter__()
    assert not is_written(results.path)
    results.delete()
    assert list(results.path.parent.iterdir()) == []


def test_a_pipe_among_the_experiments_holds_nobody_up(tmp_path):
    os.mkfifo(tmp_path / "pipe.sqlite")
    assert names(tmp_path) == []
    with pytest.raises(ExperimentNotFoundError):
        Results.open(tmp_path / "pipe.sqlite")
