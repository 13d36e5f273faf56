"""What the trials of an experiment say together, and where their results go."""

import csv
import sys

import pytest

from station.experiments.experiment import keep_worst, sweep
from station.experiments.exports import data_frame, export, table, write_gains
from station.experiments.plots import KINDS, pareto_front, plot
from station.experiments.pools import InThisProcess
from station.experiments.trial_world import default_script, small_motions
from station.trials.analysis import objective_as_plan, ranked
from station.trials.background_experiments import ExperimentProcess
from station.trials.errors import ExperimentError
from station.trials.objective import Objective
from station.trials.results import Results
from station.trials.trial import TrialResult
from tests.experiments.conftest import GROUP

PNG = b"\x89PNG"


def test_results_are_exported(results, tmp_path):
    export(results, tmp_path / "some.csv")
    export(results, tmp_path / "some.parquet")

    rows = list(csv.DictReader((tmp_path / "some.csv").read_text().splitlines()))
    assert [row["rms_error"] for row in rows] == ["3.0", "1.0", "", "2.0"]
    assert rows[1]["parameter:load"] == "0.1"
    frame = data_frame(results)
    assert list(frame.columns) == list(table(results)[0])
    assert (tmp_path / "some.parquet").read_bytes()[:4] == b"PAR1"
    with pytest.raises(ExperimentError, match=r"as 'some\.xlsx'"):
        export(results, tmp_path / "some.xlsx")


def test_front_has_what_nothing_beats_in_both():
    points = [(1.0, 5.0), (2.0, 3.0), (2.5, 4.0), (3.0, 1.0), (4.0, 1.0)]

    assert pareto_front(points) == [0, 1, 3]


@pytest.mark.slow
def test_every_plot_is_a_picture(tmp_path, step):
    path = tmp_path / "run.sqlite"
    with Results.create(path, "sweep", step.setup, {}) as results:
        loads = [{"load": 0.0}, {"load": 1.0}, {"load": 2.0}]
        sweep(step, loads, results, InThisProcess())

        for kind in KINDS:
            plot(results, kind, tmp_path / f"{kind}.png")
            assert (tmp_path / f"{kind}.png").read_bytes()[:4] == PNG
        with pytest.raises(ExperimentError, match="cannot be written"):
            plot(results, "pareto", tmp_path / "no" / "plot.png")


def test_worst_trials_are_kept_as_recordings(tmp_path, step, world):
    with Results.create(tmp_path / "w.sqlite", "robustness", step.setup, {}) as results:
        loads = [{"load": load} for load in (0.0, 3.0, 1.0)]
        sweep(step, loads, results, InThisProcess(), has_seeds=True)

        (worst,) = keep_worst(results, "steady_error", 1)

        trial = results.trial(worst)
        assert (trial.parameters["load"], trial.seed) == (3.0, 1)
        again = world.record(trial)[1]
        assert results.recordings()[worst].to_bytes() == again.to_bytes()


def test_trials_that_have_all_failed_are_kept_and_none_is_the_best(tmp_path, step):
    plan = {"goal": objective_as_plan(Objective()), "first": step.hash}
    with Results.create(tmp_path / "f.sqlite", "tune", step.setup, plan) as results:
        results.add(step, TrialResult(step.hash, "failed", "a reflex", {}, 0.1, "w"))

        assert keep_worst(results, "rms_error", 1) == [step.hash]
        assert list(results.recordings()) == [step.hash]
        with pytest.raises(ExperimentError, match="All trials of 'f' have failed"):
            ranked(results)


def test_gains_of_a_trial_are_written(tmp_path):
    write_gains({GROUP: {"panda_joint1/p": 300.0}}, tmp_path / "g")

    assert "panda_joint1/p: 300.0" in (tmp_path / "g").read_text()
    with pytest.raises(ExperimentError, match="cannot be written"):
        write_gains({}, tmp_path / "no" / "such" / "folder")


def test_default_script_moves_every_joint_away_from_its_limits(world):
    script = default_script(world, GROUP)

    assert len(script.motions) == 7
    # Joint 4 begins at -2.36 between -3.07 and -0.07: its middle is above.
    assert script.motions[3].values[0] == pytest.approx(0.2)
    assert small_motions(world, "velocity_group_controller", (1.0,), (1.0,)) == ()
    with pytest.raises(ExperimentError, match="commands no positions"):
        default_script(world, "effort_group_effort_controller")


BROKEN = """
import station.experiments.__main__ as process

def carry_out(*_):
    raise TypeError("a matrix has no name")

process.carry_out = carry_out
process.main()
"""


def test_an_error_that_nobody_expected_is_told_by_its_name(
    panda, tmp_path, monkeypatch, capfd
):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    request = {"kind": "sweep", "controller": GROUP, "name": "some", "trials": 2}
    request["ranges"] = ["load=0:1"]
    order = {"request": request, "setup": panda.text, "gains": {}}
    process = ExperimentProcess([sys.executable, "-c", BROKEN], order)
    (last,) = process.lines()
    process.end()

    assert last["end"]["state"] == "failed"
    assert (
        "TypeError in <string>, line 5: a matrix has no name" in last["end"]["reason"]
    )
    assert "Traceback" in capfd.readouterr().err
