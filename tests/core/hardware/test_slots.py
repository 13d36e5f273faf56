"""Slots that lie side by side: in lists, in views, across views of one block."""

import numpy as np
from hypothesis import given, strategies as st

from station.core.hardware.slots import in_memory_order, side_by_side
from station.memory.doubles import Block, doubles


def values_of(run):
    return list(run.storage[run.begin : run.end])


def test_neighbours_in_a_list_make_one_run():
    first, second = [0.0, 1.0, 2.0, 3.0, 4.0], [5.0]
    slots = [(first, 1), (first, 2), (first, 4), (second, 0)]

    runs = side_by_side(slots)

    assert [values_of(run) for run in runs] == [[1.0, 2.0], [4.0], [5.0]]
    assert [run.slots for run in runs] == [slots[:2], slots[2:3], slots[3:]]
    assert [run.view for run in runs] == [None, None, None]


def test_neighbouring_views_of_one_block_make_one_run():
    block = Block({"head": 2, "first": 2, "second": 3})
    block.memory[:] = doubles(range(7))
    slots = [(block["first"], 1), (block["second"], 0), (block["second"], 1)]

    (run,) = side_by_side(slots)

    assert list(run.view) == [3.0, 4.0, 5.0]
    run.view[1] = 40.0
    assert block["second"][0] == 40.0
    assert run.slots == slots


def test_memory_of_two_blocks_is_never_side_by_side():
    slots = [(doubles([1.0]), 0), (doubles([2.0]), 0)]
    assert [list(run.view) for run in side_by_side(slots)] == [[1.0], [2.0]]


def test_memory_of_an_array_is_run_by_run_for_each_of_its_views():
    array = np.arange(4.0)
    first, second = memoryview(array[:2]), memoryview(array[2:])
    slots = [(first, 0), (first, 1), (second, 0)]
    assert [list(run.view) for run in side_by_side(slots)] == [[0.0, 1.0], [2.0]]


def test_memory_order_goes_from_view_to_view():
    block = Block({"first": 2, "second": 2})
    slots = [(block["second"], 1), (block["first"], 1), (block["second"], 0)]

    ordered = in_memory_order(slots)

    assert ordered == [slots[1], slots[2], slots[0]]
    assert len(side_by_side(ordered)) == 1


@given(
    st.lists(st.tuples(st.sampled_from("abcd"), st.integers(0, 2)), max_size=12),
)
def test_runs_hold_the_slots_in_their_order(chosen):
    block = Block({"a": 3, "b": 3})
    block.memory[:] = doubles(range(6))
    storages = {"a": block["a"], "b": block["b"], "c": [6.0, 7.0, 8.0]}
    storages["d"] = doubles([9.0, 10.0, 11.0])
    slots = [(storages[name], index) for name, index in chosen]

    runs = side_by_side(slots)

    found = [value for run in runs for value in values_of(run)]
    assert found == [storage[index] for storage, index in slots]
    assert [slot for run in runs for slot in run.slots] == slots
