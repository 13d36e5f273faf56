"""The snapshot ring: every cycle readable, loss detected."""

from station.core.loop.snapshot import Record, SnapshotRing


def _snapshot(cycle: int) -> Record:
    packed = ([float(cycle)], [], [])
    return cycle, 1, cycle * 0.001, 0.001, "idle", packed, {}


def _ring(capacity: int, cycles: int) -> SnapshotRing:
    ring = SnapshotRing(capacity)
    for cycle in range(1, cycles + 1):
        ring.push(_snapshot(cycle))
    return ring


def test_an_empty_ring_has_no_latest_snapshot():
    ring = SnapshotRing(4)
    assert ring.latest() is None
    assert ring.read_since(0) == ([], 0)


def test_a_reader_that_keeps_up_gets_every_cycle_once():
    ring = _ring(8, 5)
    first, lost_first = ring.read_since(0)
    ring.push(_snapshot(6))
    second, lost_second = ring.read_since(first[-1].cycle)
    assert [s.cycle for s in first + second] == [1, 2, 3, 4, 5, 6]
    assert (lost_first, lost_second) == (0, 0)


def test_a_reader_that_falls_behind_learns_how_many_it_lost():
    snapshots, lost = _ring(4, 10).read_since(2)
    assert [s.cycle for s in snapshots] == [7, 8, 9, 10]
    assert lost == 4


def test_nothing_new_is_not_a_loss():
    assert _ring(4, 3).read_since(3) == ([], 0)


def test_a_slot_overwritten_while_reading_counts_as_lost():
    ring = _ring(4, 4)
    ring.slots[1 % 4] = _snapshot(5)  # the writer is one slot ahead of `newest`
    snapshots, lost = ring.read_since(0)
    assert [s.cycle for s in snapshots] == [2, 3, 4]
    assert lost == 1
