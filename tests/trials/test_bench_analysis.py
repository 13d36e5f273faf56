"""A part of a recording is read as the test that it has in it."""

import numpy as np
import pytest

from station.trials.bench_analysis import KeptRuns, excitation_of_part, joint_test
from station.trials.errors import BenchRunNotFoundError
from station.trials.trace import Trace
from station.wire.excitations import BenchResponse, PartRequest


def test_a_step_that_goes_back_is_read_until_it_goes_back():
    time = np.arange(3000) * 1e-3
    desired = np.where((time >= 0.5) & (time < 2.0), 0.3, 0.2)
    # A first-order answer: it rises from 10 to 90 % in ln(9) time constants.
    lag = np.exp(-np.maximum(time - 0.5, 0.0) / 0.1)
    position = np.where(time < 2.0, 0.3 - 0.1 * lag, 0.2)
    zeros = np.zeros((3000, 1))
    columns = [values[:, None] for values in (position, zeros[:, 0], zeros[:, 0])]
    trace = Trace(("j",), 1e-3, time, *columns, desired[:, None], zeros, zeros)
    part = PartRequest(controller="arm", joint="j", kind="step")

    excitation, script, chosen = excitation_of_part(part, trace)
    found = joint_test(chosen, excitation, script, {})

    assert excitation.amplitude == pytest.approx(0.1)
    assert found.metrics["rise_time"] == pytest.approx(0.1 * np.log(9.0), abs=0.002)
    assert found.metrics["overshoot"] == pytest.approx(0.0, abs=1e-3)
    assert found.proposals == []


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
