"""Numbers as JSON can say them."""

import math

import pytest

from station.api.wire_numbers import measured, measured_list


@pytest.mark.parametrize(
    ("value", "told"), [(1.5, 1.5), (math.inf, None), (math.nan, None)]
)
def test_what_is_not_finite_becomes_none(value, told):
    assert measured(value) == told
    assert measured_list([value, 0.0]) == [told, 0.0]
