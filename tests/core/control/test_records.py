"""A cycle is left as it was, in both modes, and never found half-written."""

from hypothesis import given
from hypothesis import strategies as st

from station.core.control.records import HEAD, Records
from station.memory.doubles import doubles
from tests.both_modes import arrays, assert_same, needs_both, sibling


def test_a_row_is_not_whole_before_it_ends():
    records = Records(2)
    records.prepare([doubles([1.0]), doubles([2.0, 3.0])], 5)
    begin = records.begin(3, 7, 0.5, 0.25, "idle")

    assert (records.newest, records.memory[records.width]) == (0, 0.0)
    records.end(3, (), None)

    assert records.newest == 3
    row = records.memory[records.width : 2 * records.width].tolist()
    assert row == [3.0, 7.0, 0.5, 0.25, 1.0, 2.0, 3.0, *[0.0] * 5]
    assert begin == records.width + HEAD + 3


@needs_both
@given(arrays(3), arrays(4), st.lists(st.booleans(), min_size=1, max_size=5))
def test_both_modes_leave_the_same(states, column, there):
    def scenario(module):
        sampled = sibling(module, "sample_columns").SampleColumns([doubles(column)] * 4)
        records = module.Records(3)
        records.prepare([doubles(states)], 20)
        found = []
        for cycle, is_there in enumerate(there, 1):
            sampled.keep(0.125 * cycle)
            begin = records.begin(cycle, 1, 0.5, 0.001, "idle")
            records.add(begin + 2, sampled, is_there)
            records.end(cycle, (), None)
            found += records.memory.tolist()
        return found

    assert_same("records", scenario)
