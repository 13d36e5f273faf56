"""What makes a trial better: weights, and bounds that outweigh them."""

import pytest

from station.trials.errors import (
    ExperimentError,
    ImpossibleRangeError,
    UnknownParameterError,
)
from station.trials.objective import Bound, Objective
from station.trials.trial import TrialResult

FIRST = {"rms_error": 0.1, "effort_rms": 10.0, "limit_margin": 0.5}


def result(state="done", **metrics):
    return TrialResult("h", state, None, {**FIRST, **metrics}, 0.1, "w")


def test_cost_is_relative_to_the_first_trial():
    objective = Objective({"rms_error": 1.0, "limit_margin": 3.0}, ())

    assert objective.cost(result(), FIRST) == 1.0
    assert objective.cost(result(rms_error=0.05), FIRST) == pytest.approx(0.875)
    assert objective.cost(result(limit_margin=1.0), FIRST) == pytest.approx(0.625)


def test_bounds_outweigh_everything_and_failure_outweighs_bounds():
    objective = Objective(
        {"rms_error": 1.0}, (Bound("effort_rms", 1.1, is_relative=True),)
    )

    costs = [
        objective.cost(result(effort_rms=effort, rms_error=1e-6), FIRST)
        for effort in (10.9, 11.1, 22.0)
    ]

    assert costs[0] < 1.0 < 1e3 < costs[1] < costs[2]
    assert objective.cost(result("failed"), FIRST) > costs[2]


def test_relative_bounds_are_compared_to_a_tenth_of_a_percent():
    relative = Bound("effort_rms", 1.0, is_relative=True)
    absolute = Bound("effort_rms", 10.0)

    assert relative.excess({"effort_rms": 10.009}, FIRST) == 0.0
    assert relative.excess({"effort_rms": 10.02}, FIRST) == pytest.approx(
        0.001, rel=0.1
    )
    assert absolute.excess({"effort_rms": 10.009}, FIRST) == pytest.approx(0.0009)


def test_a_softened_bound_costs_what_its_strictness_says():
    objective = Objective({"rms_error": 1.0}, (Bound("effort_rms", 8.0),))
    inside, outside = result(effort_rms=8.0, rms_error=0.05), result(rms_error=0.05)

    assert (
        objective.softened(inside, FIRST, 100.0) == objective.cost(inside, FIRST) == 0.5
    )
    assert objective.softened(outside, FIRST, 100.0) == pytest.approx(
        0.5 + 100.0 * 0.25
    )
    assert objective.softened(result("failed"), FIRST, 0.0) >= 1e6


def test_what_never_settles_exceeds_a_bound_of_its_settling_time():
    objective = Objective({"rms_error": 1.0}, (Bound("settling_time", 0.5),))
    slow = result(settling_time=0.9)

    assert objective.excess(slow, FIRST) == pytest.approx(0.8)
    assert objective.excess(result(), FIRST) == 10.0
    assert (
        objective.softened(slow, FIRST, 1.0)
        < objective.softened(result(), FIRST, 1.0)
        < 1e3
    )


def test_impossible_goals_are_refused_by_name():
    with pytest.raises(UnknownParameterError, match="no metric 'speed'"):
        Objective({"speed": 1.0})
    with pytest.raises(ImpossibleRangeError, match="weight of 'energy' is 0"):
        Objective({"energy": 0.0})
    with pytest.raises(ImpossibleRangeError, match="one weight"):
        Objective({})
    with pytest.raises(ImpossibleRangeError, match="bound of 'energy' is nan"):
        Bound("energy", float("nan"))
    with pytest.raises(ExperimentError, match="has no metric 'overshoot'"):
        Objective({"overshoot": 1.0}, ()).cost(result(), FIRST)
