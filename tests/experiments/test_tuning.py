"""A search for gains begins at the present ones and keeps its bounds."""

import re

import pytest

from station.experiments.pools import InThisProcess
from station.experiments.tuning import (
    Search,
    tunable_gains,
    tune,
)
from station.trials.errors import (
    ExperimentError,
    UnknownParameterError,
)
from station.trials.objective import Bound, Objective
from station.trials.results import Results
from tests.experiments.conftest import GROUP

GAINS = {f"gains/{GROUP}/panda_joint1/p": 120.0, f"gains/{GROUP}/panda_joint1/d": 150.0}


def test_gains_that_a_search_changes():
    gains = {"a/p": 5.0, "a/i": 0.0, "a/i_clamp_max": 1.0, "speed_scaling": 1.0}

    assert tunable_gains(gains) == {"a/p": 5.0}
    assert tunable_gains(gains, ["speed_scaling"]) == {"speed_scaling": 1.0}
    with pytest.raises(UnknownParameterError, match="no positive gain that ends in i"):
        tunable_gains(gains, ["i"])


def search(first, path, trials=24):
    objective = Objective(bounds=(Bound("violations", 0.0),))
    with Results.create(path, "tune", first.setup, {}) as results:
        tuned = tune(first, GAINS, objective, Search(trials), results, InThisProcess())
        return tuned, [row.result.hash for row in results.rows()]


@pytest.mark.slow
def test_search_improves_and_goes_on_after_it_was_killed(step, tmp_path):
    first = step.with_parameters(GAINS)

    tuned, hashes = search(first, tmp_path / "whole.sqlite")
    search(first, tmp_path / "parts.sqlite", trials=10)
    again, resumed = search(first, tmp_path / "parts.sqlite")

    assert tuned.best_cost < 0.9
    assert (tuned.progress.ended, tuned.progress.total) == (len(hashes), 24)
    assert re.fullmatch(
        r"Another generation, of \d+ trials, would exceed 24\.", tuned.stopped
    )
    assert (
        tuned.best_result.metrics["rms_error"] < tuned.first_result.metrics["rms_error"]
    )
    assert set(tuned.best.parameters) == set(GAINS)
    assert (again.best.hash, again.best_cost) == (tuned.best.hash, tuned.best_cost)
    assert sorted(resumed) == sorted(hashes)


def test_no_gain_leaves_its_range(step, tmp_path):
    objective = Objective(bounds=(Bound("violations", 0.0),))
    p, d = GAINS
    ranges = {p: (110.0, 125.0), d: (10.0, GAINS[d])}  # d begins at its largest value
    with Results.create(tmp_path / "in.sqlite", "tune", step.setup, {}) as results:
        tune(
            *(step.with_parameters(GAINS), GAINS, objective, Search(20), results),
            InThisProcess(),
            ranges=ranges,
        )
        tried = [dict(row.parameters) for row in results.rows()]

    assert len({each[p] for each in tried}) > 5
    for name, (low, high) in ranges.items():
        assert all(low <= each[name] <= high for each in tried)


def test_search_that_begins_with_a_failure_is_refused(step, tmp_path):
    with pytest.raises(ExperimentError, match=r"first trial .* has failed.*'weight'"):
        search(step.with_parameters({"weight": 1.0}), tmp_path / "bad.sqlite")
    with pytest.raises(ExperimentError, match="A search of 1 trials"):
        search(step, tmp_path / "short.sqlite", trials=1)
