"""Filters against their difference equations, and what is refused."""

import numpy as np
import pytest

from station.core.errors import ParameterError
from station.core.toolbox.filters import FilterChain

STEP = [[0.0, 1.0]] * 3 + [[1.0, -1.0]] * 20


def one(kind, **params):
    return {"filter1": {"name": "it", "type": kind, "params": params}}


def run(value, rows=STEP):
    chain = FilterChain.read(value, "it/filter_chain")
    return np.array([chain.update(row) for row in rows])


def test_the_mean_is_that_of_the_last_values():
    rows = np.array(STEP)
    found = run(one("filters/MeanFilterDouble", number_of_observations=4))

    expected = [rows[max(0, k - 3) : k + 1].mean(axis=0) for k in range(len(rows))]
    assert found == pytest.approx(np.array(expected))


def test_the_median_ignores_a_spike():
    rows = [[0.0], [0.1], [9.0], [0.2], [0.1]]
    kind = "filters/MedianFilterMultiChannelDouble"
    found = run(one(kind, number_of_observations=3), rows)

    assert found[2:].ravel() == pytest.approx([0.1, 0.2, 0.2])


def test_the_median_of_an_even_number_is_the_lower_one_in_the_middle():
    kind = "filters/MedianFilterDouble"
    found = run(one(kind, number_of_observations=4), [[3.0], [1.0], [7.0], [5.0]])

    # kth_smallest of rank n / 2 - 1 if n is even, else n / 2.
    assert found.ravel() == pytest.approx([3.0, 1.0, 3.0, 3.0])


def test_the_low_pass_is_that_of_control_toolbox():
    found = run(
        one(
            "control_filters/LowPassFilterWrench",
            sampling_frequency=1000.0,
            damping_frequency=20.5,
            damping_intensity=1.25,
            divider=1,
        )
    )

    # out[k] = b in[k-1] + a out[k-1], begun at rest.
    a = np.exp(-1 / 1000.0 * (2 * np.pi * 20.5) / 10 ** (1.25 / -10))
    rows = np.array(STEP)
    expected, last = [], rows[0]
    for before in [rows[0], *rows[:-1]]:
        last = (1 - a) * before + a * last
        expected.append(last)
    assert found == pytest.approx(np.array(expected))


def test_filters_follow_each_other():
    smooth = {
        "type": "control_filters/ExponentialFilterDouble",
        "params": {"alpha": 0.5},
    }
    found = run({"filter1": smooth, "filter2": smooth}, [[0.0], [1.0], [1.0]])

    assert found.ravel() == pytest.approx([0.0, 0.25, 0.5])


@pytest.mark.parametrize("value", [None, "none", {}])
def test_no_filter_lets_all_pass(value):
    assert run(value) == pytest.approx(np.array(STEP))


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("fast", "a mapping with filter1"),
        ({"filter2": {}}, "one of .'filter1'."),
        (one("filters/NoFilterDouble"), "filters/MeanFilterDouble"),
        (one("filters/MeanFilterDouble"), "number_of_observations' is None"),
        (one("filters/MeanFilterDouble", number_of_observations=0), "from 1"),
        (one("filters/MeanFilterDouble", size=1), "left out"),
        (one("control_filters/ExponentialFilterDouble", alpha=float("nan")), "to 1"),
    ],
)
def test_what_a_chain_does_not_know_is_refused(value, words):
    with pytest.raises(ParameterError, match=words):
        FilterChain.read(value, "it/filter_chain")
