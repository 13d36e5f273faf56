"""The snapshot ring: every cycle readable, loss detected."""

from array import array

import numpy as np
import pytest
from hypothesis import given, strategies as st

from station.core.control import loaded_controller
from station.core.control.controller import (
    ControllerBase,
    ControllerSample,
    ControllerState,
)
from station.core.control.sample_columns import SampleColumns
from station.core.hardware.robot_hw import ControllerInfo
from station.core.loop.snapshot import HEAD, SnapshotRing
from station.memory.doubles import doubles
from tests.both_modes import arrays, assert_same, needs_both, sibling

STATES = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)  # positions, velocities, efforts of two joints


def _push(ring: SnapshotRing, cycle: int, mode: str = "idle") -> None:
    ring.leave_row(cycle, 1, cycle * 0.001, 0.001, mode, ())


def _ring(capacity: int, cycles: int) -> SnapshotRing:
    ring = SnapshotRing(capacity)
    ring.prepare([doubles(STATES)], 0)
    for cycle in range(1, cycles + 1):
        _push(ring, cycle)
    return ring


def _running(name, module, sampled=None):
    """Return a controller that runs, loaded by the module `loaded_controller`."""
    controller = ControllerBase()
    controller.state, controller.sampled = ControllerState.RUNNING, sampled
    info = ControllerInfo(name, "test/Test", ())
    loaded = module.LoadedController(controller, info, [], (), may_jump=False)
    loaded.watch_first_update()
    return loaded


def test_an_empty_ring_has_no_latest_snapshot():
    ring = SnapshotRing(4)
    assert ring.latest() is None
    assert ring.read_since(0) == ([], 0)


def test_a_snapshot_has_what_the_cycle_has_left():
    snapshot = _ring(4, 5).latest()

    assert (snapshot.cycle, snapshot.epoch, snapshot.mode) == (5, 1, "idle")
    assert (snapshot.stamp, snapshot.period) == (0.005, 0.001)
    assert snapshot.position == [1.0, 2.0]
    assert snapshot.velocity == [3.0, 4.0]
    assert snapshot.effort == [5.0, 6.0]
    assert snapshot.samples == {}


def test_a_reader_that_keeps_up_gets_every_cycle_once():
    ring = _ring(8, 5)
    first, lost_first = ring.read_since(0)
    _push(ring, 6)
    second, lost_second = ring.read_since(first[-1].cycle)
    assert [s.cycle for s in first + second] == [1, 2, 3, 4, 5, 6]
    assert (lost_first, lost_second) == (0, 0)


def test_a_reader_that_falls_behind_learns_how_many_it_lost():
    snapshots, lost = _ring(4, 10).read_since(2)
    assert [s.cycle for s in snapshots] == [7, 8, 9, 10]
    assert lost == 4


def test_nothing_new_is_not_a_loss():
    assert _ring(4, 3).read_since(3) == ([], 0)


@pytest.mark.parametrize("is_whole", [False, True])
def test_a_cycle_overwritten_while_reading_counts_as_lost(is_whole):
    ring = _ring(4, 4)
    # What a reader finds that looked at `newest` before the writer went on.
    ring.memory[1 * ring.width] = 5.0 if is_whole else 0.0
    snapshots, lost = ring.read_since(0)
    assert [s.cycle for s in snapshots] == [2, 3, 4]
    assert lost == 1


def test_samples_are_read_from_the_row_or_as_the_objects_they_are():
    ring, sampled = SnapshotRing(4), SampleColumns([doubles([1.0, 2.0])] * 4)
    ring.prepare([], sampled.width)
    mine = ControllerSample(0.5, [1.0], [2.0], [3.0], [4.0])
    running = (
        _running("arm", loaded_controller, sampled),
        _running("mine", loaded_controller),
    )
    running[1].controller.sample = mine
    sampled.keep(0.25)
    ring.leave_row(1, 1, 0.001, 0.001, "idle", running)
    for one in running:
        one.controller.state = ControllerState.STOPPED
    ring.leave_row(2, 1, 0.001, 0.001, "idle", running)

    (first, second), _ = ring.read_since(0)

    assert list(first.samples) == ["arm", "mine"]
    assert first.samples["arm"].stamp == 0.25
    assert first.samples["arm"].columns == ([1.0, 2.0],) * 4
    assert first.samples["mine"] is mine
    assert second.samples == {}
    columns = ring.rows_since(0).columns_of("arm", 2)
    assert columns[0].tolist() == [[1.0, 2.0]] * 4
    assert columns[1].tobytes() == array("d", [float("nan")] * 8).tobytes()
    mine = ring.rows_since(0).columns_of("mine", 1)
    assert mine[0].tolist() == [[1.0], [2.0], [3.0], [4.0]]
    assert mine[1].tobytes() == array("d", [float("nan")] * 4).tobytes()
    assert np.isnan(ring.rows_since(0).columns_of("arm", 3)).all()


def test_rows_tell_their_newest_cycle_and_the_time_of_each():
    rows = _ring(4, 10).rows_since(2)

    assert len(rows) == 4
    assert rows.newest == 10
    assert rows.time_of(8) == 0.008
    assert rows.time_of(3) == 0.007  # lost: the first that is there
    assert rows.time_of(12) == 0.010  # to come: the last


def test_a_row_begins_with_its_cycle_and_has_the_states_of_the_joints():
    ring = SnapshotRing(2)
    ring.prepare([doubles([1.0]), doubles([2.0, 3.0])], 5)
    ring.leave_row(3, 7, 0.5, 0.25, "idle", ())

    assert ring.newest == 3
    row = ring.memory[ring.width : 2 * ring.width].tolist()
    assert row == [3.0, 7.0, 0.5, 0.25, 1.0, 2.0, 3.0, *[0.0] * 5]
    assert len(row) == HEAD + 3 + 5


def test_what_does_not_fit_into_a_row_is_kept_as_an_object():
    ring, sampled = SnapshotRing(2), SampleColumns([doubles([1.0, 2.0])] * 4)
    ring.prepare([], 2 * sampled.width - 1)
    running = tuple(_running(n, loaded_controller, sampled) for n in ("a", "b"))
    sampled.keep(0.25)
    ring.leave_row(1, 1, 0.001, 0.001, "idle", running)

    assert list(ring.objects[1]) == ["b"]
    first, second = ring.latest().samples.values()
    assert first.columns == second.columns == ([1.0, 2.0],) * 4


@needs_both
@given(arrays(3), arrays(4), st.lists(st.booleans(), min_size=1, max_size=5))
def test_both_modes_leave_the_same(states, column, there):
    def scenario(module):
        sampled = sibling(module, "sample_columns").SampleColumns([doubles(column)] * 4)
        one = _running("arm", sibling(module, "loaded_controller"), sampled)
        ring = module.SnapshotRing(3)
        ring.prepare([doubles(states)], 20)
        found = []
        for cycle, is_there in enumerate(there, 1):
            state = ControllerState.RUNNING if is_there else ControllerState.STOPPED
            one.controller.state = state
            sampled.keep(0.125 * cycle)
            ring.leave_row(cycle, 1, 0.5, 0.001, "idle", (one,))
            found += ring.memory.tolist()
        return found

    assert_same("snapshot", scenario)
