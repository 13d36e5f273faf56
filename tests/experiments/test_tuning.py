"""A search for gains begins at the present ones and keeps its bounds."""

import pytest

from station.experiments.errors import (
    ExperimentError,
    ImpossibleRangeError,
    UnknownParameterError,
)
from station.experiments.pools import InThisProcess
from station.experiments.results import Results
from station.experiments.trial import TrialResult
from station.experiments.tuning import (
    Bound,
    Goal,
    Search,
    tunable_gains,
    tune,
)
from tests.experiments.conftest import GROUP

FIRST = {"rms_error": 0.1, "effort_rms": 10.0, "limit_margin": 0.5}
GAINS = {f"gains/{GROUP}/panda_joint1/p": 120.0, f"gains/{GROUP}/panda_joint1/d": 150.0}


def result(state="done", **metrics):
    return TrialResult("h", state, None, {**FIRST, **metrics}, 0.1, "w")


def test_cost_is_relative_to_the_first_trial():
    goal = Goal({"rms_error": 1.0, "limit_margin": 3.0}, ())

    assert goal.cost(result(), FIRST) == 1.0
    assert goal.cost(result(rms_error=0.05), FIRST) == pytest.approx(0.875)
    assert goal.cost(result(limit_margin=1.0), FIRST) == pytest.approx(0.625)


def test_bounds_outweigh_everything_and_failure_outweighs_bounds():
    goal = Goal({"rms_error": 1.0}, (Bound("effort_rms", 1.1, is_relative=True),))

    costs = [
        goal.cost(result(effort_rms=effort, rms_error=1e-6), FIRST)
        for effort in (10.9, 11.1, 22.0)
    ]

    assert costs[0] < 1.0 < 1e3 < costs[1] < costs[2]
    assert goal.cost(result("failed"), FIRST) > costs[2]


def test_impossible_goals_are_refused_by_name():
    with pytest.raises(UnknownParameterError, match="no metric 'speed'"):
        Goal({"speed": 1.0})
    with pytest.raises(ImpossibleRangeError, match="weight of 'energy' is 0"):
        Goal({"energy": 0.0})
    with pytest.raises(ImpossibleRangeError, match="one weight"):
        Goal({})
    with pytest.raises(ImpossibleRangeError, match="bound of 'energy' is nan"):
        Bound("energy", float("nan"))
    with pytest.raises(ExperimentError, match="has no metric 'overshoot'"):
        Goal({"overshoot": 1.0}, ()).cost(result(), FIRST)


def test_gains_that_a_search_changes():
    gains = {"a/p": 5.0, "a/i": 0.0, "a/i_clamp_max": 1.0, "speed_scaling": 1.0}

    assert tunable_gains(gains) == {"a/p": 5.0}
    assert tunable_gains(gains, ["speed_scaling"]) == {"speed_scaling": 1.0}
    with pytest.raises(UnknownParameterError, match="no positive gain that ends in i"):
        tunable_gains(gains, ["i"])


def search(first, path, trials=24):
    goal = Goal(bounds=(Bound("violations", 0.0),))
    with Results.create(path, "tune", first.setup, {}) as results:
        tuned = tune(first, GAINS, goal, Search(trials), results, InThisProcess())
        return tuned, [row.result.hash for row in results.rows()]


@pytest.mark.slow
def test_search_improves_and_goes_on_after_it_was_killed(step, tmp_path):
    first = step.with_parameters(GAINS)

    tuned, hashes = search(first, tmp_path / "whole.sqlite")
    search(first, tmp_path / "parts.sqlite", trials=10)
    again, resumed = search(first, tmp_path / "parts.sqlite")

    assert tuned.best_cost < 0.9
    assert (
        tuned.best_result.metrics["rms_error"] < tuned.first_result.metrics["rms_error"]
    )
    assert set(tuned.best.parameters) == set(GAINS)
    assert (again.best.hash, again.best_cost) == (tuned.best.hash, tuned.best_cost)
    assert sorted(resumed) == sorted(hashes)


def test_search_that_begins_with_a_failure_is_refused(step, tmp_path):
    with pytest.raises(ExperimentError, match=r"first trial .* has failed.*'weight'"):
        search(step.with_parameters({"weight": 1.0}), tmp_path / "bad.sqlite")
    with pytest.raises(ExperimentError, match="A search of 1 trials"):
        search(step, tmp_path / "short.sqlite", trials=1)
