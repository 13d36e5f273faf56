"""Ranges and the points within them.

Sobol's sequence fills the cube evenly.
"""

import numpy as np
import pytest

from station.experiments.designs import Range, parse_range, points, sobol
from station.trials.errors import (
    ImpossibleRangeError,
    UnknownParameterError,
)


def test_grid_has_every_combination():
    ranges = [parse_range("load=0:2:3"), parse_range("delay=0,3")]

    found = points(ranges, "grid", 0)

    assert [tuple(p.values()) for p in found] == [
        *((0.0, 0.0), (0.0, 3.0), (1.0, 0.0)),
        *((1.0, 3.0), (2.0, 0.0), (2.0, 3.0)),
    ]


@pytest.mark.parametrize("method", ["random", "halton"])
def test_points_are_in_their_ranges_and_the_same_every_time(method):
    ranges = [parse_range("load=1:3"), parse_range("delay=0:3")]

    found = points(ranges, method, 200, seed=4)

    loads = [p["load"] for p in found]
    assert min(loads) >= 1.0
    assert max(loads) <= 3.0
    delays = [p["delay"] for p in found]
    assert {float(d) for d in range(4)} == set(delays)
    assert all(30 <= delays.count(d) <= 70 for d in range(4))
    assert points(ranges, method, 200, seed=4) == found
    assert points(ranges, method, 200, seed=5) != found


def test_halton_spreads_points_more_evenly_than_chance():
    square = [Range("load", 0.0, 1.0), Range("friction", 0.0, 1.0)]

    def unevenness(method):
        found = np.array([list(p.values()) for p in points(square, method, 256, 1)])
        counts, *_ = np.histogram2d(*found.T, bins=8, range=[[0, 1], [0, 1]])
        return counts.std()

    assert unevenness("halton") < 0.6 * unevenness("random")


@pytest.mark.parametrize(
    ("text", "error", "reason"),
    [
        ("weight=0:1", UnknownParameterError, "no parameter 'weight'"),
        ("load=3:1", ImpossibleRangeError, "is empty: 3 to 1"),
        ("load=0:1:0", ImpossibleRangeError, "in 0 points"),
        ("load=-1:1", ImpossibleRangeError, "cannot be -1; allowed are 0 to 100"),
        ("load=0:nan", ImpossibleRangeError, "has nan"),
        ("load", ImpossibleRangeError, "'load' is no range"),
        ("load=a:b", ImpossibleRangeError, "is no range"),
        ("load=0:1:2:3", ImpossibleRangeError, "is no range"),
        ("delay=0,1.5", ImpossibleRangeError, "cannot be 1.5; allowed are whole"),
        ("gains/x=0:1", UnknownParameterError, "names no gain"),
    ],
)
def test_impossible_range_is_refused_by_name(text, error, reason):
    with pytest.raises(error) as caught:
        parse_range(text)

    assert reason in caught.value.message


def test_impossible_designs_are_refused():
    load = parse_range("load=0:1")

    with pytest.raises(ImpossibleRangeError, match="needs to know how many"):
        points([load], "grid", 5)
    with pytest.raises(ImpossibleRangeError, match="load, load"):
        points([load, load], "random", 5)
    with pytest.raises(ImpossibleRangeError, match="would have 0 trials"):
        points([load], "random", 0)
    with pytest.raises(ImpossibleRangeError, match="allowed are 1 to 1000000"):
        points([parse_range("load=0:1:2000000")], "grid", 0)


def test_sobol_spreads_points_over_the_ranges():
    found = points([parse_range("load=0:2"), parse_range("delay=0:3")], "sobol", 16)

    assert sorted(int(p["load"] * 8) for p in found) == list(range(16))
    assert {p["delay"] for p in found} == {0.0, 1.0, 2.0, 3.0}


def test_first_points_are_those_of_the_literature():
    """The differences by XOR from the first point are independent of the shift.

    The first points of Joe and Kuo in three dimensions: 0, 1/2, 3/4 1/4 1/4,
    1/4 3/4 3/4, 3/8 3/8 5/8.
    """
    bits = (np.array(sobol(5, 3)) * 2**32).astype(np.uint64)

    unshifted = (bits ^ bits[0]) / 2.0**32

    assert unshifted.tolist() == [
        [0.0, 0.0, 0.0],
        [0.5, 0.5, 0.5],
        [0.75, 0.25, 0.25],
        [0.25, 0.75, 0.75],
        [0.375, 0.375, 0.625],
    ]


@pytest.mark.parametrize("seed", [0, 5])
def test_every_interval_of_every_dimension_has_as_many_points(seed):
    points = np.array(sobol(256, 25, seed))

    for column in points.T:
        assert sorted((column * 256).astype(int)) == list(range(256))


def test_squares_of_the_first_two_dimensions_have_one_point_each():
    points = np.array(sobol(256, 2))

    squares = {(int(x * 16), int(y * 16)) for x, y in points}

    assert len(squares) == 256


def test_seeds_shift_the_points():
    assert sobol(4, 2, 1) == sobol(4, 2, 1) != sobol(4, 2, 2)
