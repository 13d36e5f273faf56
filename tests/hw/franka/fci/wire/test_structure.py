"""Packed structures: sizes, offsets, and what does not fit."""

import struct

import pytest

from station.hw.franka.fci.wire.structure import Structure

POINT = Structure([("id", "H"), ("xyz", "3d"), ("is_set", "?"), ("one", "1d")])


def test_fields_follow_each_other_without_gaps_little_endian():
    data = POINT.pack({"id": 0x0102, "xyz": (1.0, 2.0, 3.0), "is_set": True})
    assert POINT.offsets == {"id": 0, "xyz": 2, "is_set": 26, "one": 27}
    assert len(data) == POINT.size == 35
    assert data[:2] == b"\x02\x01"
    assert struct.unpack_from("<3d", data, 2) == (1.0, 2.0, 3.0)


def test_a_field_with_a_count_is_a_tuple_and_what_is_left_out_is_zero():
    assert POINT.unpack(POINT.pack({"id": 7})) == {
        "id": 7,
        "xyz": (0.0, 0.0, 0.0),
        "is_set": False,
        "one": (0.0,),
    }


def test_values_that_do_not_fit_are_refused():
    with pytest.raises(KeyError, match="speed"):
        POINT.pack({"speed": 1.0})
    with pytest.raises(ValueError, match="xyz has 2 numbers instead of 3"):
        POINT.pack({"xyz": (1.0, 2.0)})
    with pytest.raises(struct.error):
        POINT.pack({"id": 70_000})
    with pytest.raises(struct.error):
        POINT.unpack(bytes(34))
