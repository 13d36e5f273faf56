"""Sobol's sequence fills the cube evenly."""

import numpy as np
import pytest

from station.experiments.sobol import WIDEST, sobol
from station.trials.errors import ImpossibleRangeError


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
    points = np.array(sobol(256, WIDEST, seed))

    for column in points.T:
        assert sorted((column * 256).astype(int)) == list(range(256))


def test_squares_of_the_first_two_dimensions_have_one_point_each():
    points = np.array(sobol(256, 2))

    squares = {(int(x * 16), int(y * 16)) for x, y in points}

    assert len(squares) == 256


def test_seeds_shift_the_points():
    assert sobol(4, 2, 1) == sobol(4, 2, 1) != sobol(4, 2, 2)


def test_too_many_dimensions_are_refused():
    with pytest.raises(ImpossibleRangeError, match="22 parameters here; allowed are 1"):
        sobol(4, 22)
