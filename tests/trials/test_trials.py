"""What trials say together, and what follows from their parameters."""

import numpy as np
import pytest

from station.trials.analysis import (
    compare,
    gains_of,
    objective_as_plan,
    objective_of,
    ranked,
    summary,
)
from station.trials.errors import ExperimentError, UnknownParameterError
from station.trials.objective import Bound, Objective
from station.trials.parameters import gains_under, sort_out
from station.trials.results import Results
from tests.trials.conftest import fill


def test_best_comes_first_and_failed_trials_not_at_all(results):
    assert [row.result.metrics["rms_error"] for row in ranked(results)] == [1, 2, 3]
    assert ranked(results, "effort_rms")[0].result.metrics["rms_error"] == 3.0
    with pytest.raises(UnknownParameterError, match="no metric 'speed'"):
        ranked(results, "speed")
    with pytest.raises(ExperimentError, match="has the metric 'overshoot'"):
        ranked(results, "overshoot")


def test_goal_of_a_search_decides_which_trial_is_best(tmp_path, step):
    objective = Objective(
        {"rms_error": 1.0}, (Bound("effort_rms", 1.5, is_relative=True),)
    )
    first = step.with_parameters({"load": 0.0}).hash
    plan = {"first": first, "goal": objective_as_plan(objective)}

    with fill(tmp_path / "t.sqlite", step, [3.0, 1.0, 2.5], "tune", plan) as results:
        # An error of 1 takes three times the effort, which is out of bounds.
        assert objective_of(results) == objective
        assert [r.result.metrics["rms_error"] for r in ranked(results)] == [
            2.5,
            3.0,
            1.0,
        ]


def test_summary_has_the_worst_trial(results):
    error, effort = summary(results)

    assert (error.metric, error.median, error.worst, error.count) == (
        *("rms_error", 2.0),
        *(3.0, 3),
    )
    assert effort.worst_hash == ranked(results)[0].result.hash


def test_comparison_tells_chance_from_difference(tmp_path, step):
    random = np.random.default_rng(1)
    draws = {name: random.normal(1.0, 0.1, 20).tolist() for name in "ab"}
    draws["c"] = random.normal(1.3, 0.1, 20).tolist()
    one, same, other = (
        fill(tmp_path / f"{name}.sqlite", step, values)
        for name, values in draws.items()
    )

    with one, same, other:
        assert compare(one, other, ["rms_error"])[0].p_value <= 2e-4
        assert compare(one, same, ["rms_error"])[0].p_value > 0.05
        with pytest.raises(ExperimentError, match="no metric in common"):
            compare(one, other, ["overshoot"])


def test_gains_under_a_trial_are_scaled_first_and_then_set():
    base = {"arm": {"a/p": 10.0, "a/d": 1.0, "b/p": 20.0}, "other": {"k": 3.0}}
    wanted = sort_out({"scale/arm/p": 0.5, "gains/arm/b/p": 7.0})

    found = gains_under(wanted, base)

    assert found["arm"] == {"a/p": 5.0, "a/d": 1.0, "b/p": 7.0}
    assert found["other"] == {"k": 3.0}
    assert base["arm"]["a/p"] == 10.0


@pytest.mark.parametrize(
    ("name", "match"),
    [
        ("scale/arm/q", "No gain of 'arm' ends in '/q'"),
        ("gains/arm/c/p", "'arm' has no gain 'c/p'"),
    ],
)
def test_gains_that_there_are_not_are_refused_by_name(name, match):
    with pytest.raises(UnknownParameterError, match=match):
        gains_under(sort_out({name: 1.0}), {"arm": {"a/p": 10.0}})


def test_gains_of_a_trial_are_those_that_it_sets_or_scales(tmp_path, step):
    before = {"arm": {"a/p": 10.0, "a/d": 1.0}}
    plan = {"gains_before": before}
    scaled = step.with_parameters({"scale/arm/p": 0.5})
    with Results.create(tmp_path / "x.sqlite", "sweep", step.setup, plan) as results:
        assert gains_of(results, scaled) == {"arm": {"a/p": 5.0}}
        named = step.with_parameters({"gains/arm/a/d": 2.0})
        assert gains_of(results, named) == {"arm": {"a/d": 2.0}}
        with pytest.raises(ExperimentError, match="changes no gains"):
            gains_of(results, step)
    with (
        Results.create(tmp_path / "y.sqlite", "sweep", step.setup, {}) as results,
        pytest.raises(ExperimentError, match="does not say what they were before"),
    ):
        gains_of(results, scaled)
