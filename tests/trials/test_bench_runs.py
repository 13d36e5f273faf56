"""Runs of the bench are kept, listed, read and deleted by name."""

import pytest

from station.trials.bench_analysis import KeptRuns
from station.trials.errors import BenchRunNotFoundError
from station.wire.excitations import BenchResponse


def run_of(kind="step", **metrics):
    return BenchResponse(
        controller="arm",
        joint="j",
        kind=kind,
        gains={},
        time=[0.0],
        desired=[None],
        position=[0.0],
        velocity=[0.0],
        effort=[0.0],
        output=[0.0],
        metrics=metrics,
        units={},
        cycles=1,
        lost=0,
    )


def test_runs_are_kept_under_names_of_their_own(tmp_path):
    runs = KeptRuns(tmp_path / "runs")
    assert runs.list() == []

    names = [runs.keep(run_of(), name).name for name in (None, "soft", None)]

    assert names == ["step-1", "soft", "step-3"]
    assert {one.name for one in KeptRuns(tmp_path / "runs").list()} == set(names)
    runs.keep(run_of(overshoot=0.5), "soft")
    assert runs.get("soft").metrics == {"overshoot": 0.5}
    assert len(runs.list()) == 3


def test_a_deleted_run_is_gone_and_its_name_free(tmp_path):
    runs = KeptRuns(tmp_path)
    runs.keep(run_of("sine"), "slow")

    assert runs.delete("slow").kind == "sine"

    with pytest.raises(BenchRunNotFoundError, match="no run 'slow'"):
        runs.get("slow")
    assert runs.list() == []


def test_a_foreign_file_is_left_out(tmp_path):
    (tmp_path / "notes.json").write_text("{}")
    assert KeptRuns(tmp_path).list() == []
