"""The columns of a sample are packed as they are at the moment."""

from array import array

from station.core.control.sample_columns import SampleColumns
from station.memory.doubles import doubles


def test_nothing_is_packed_before_the_first_cycle():
    assert SampleColumns([doubles([1.0])]).newest is None


def test_columns_of_several_lengths_are_packed_one_after_the_other():
    first, second = doubles([1.0, 2.0]), doubles([3.0, 4.0, 5.0])
    sampled = SampleColumns([first, second, first])
    sampled.keep(7.5)
    first[0] = 9.0  # what is packed does not change any more
    values = array("d", [1.0, 2.0, 3.0, 4.0, 5.0, 1.0, 2.0])
    assert sampled.newest == (7.5, values.tobytes(), 2)
