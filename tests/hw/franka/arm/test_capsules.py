"""Distances between segments against a fine search, and both modes."""

import pytest
from hypothesis import given, settings

from station.core.geometry.distances import place_segments
from station.hw.franka.arm import capsules
from station.memory.doubles import doubles, indices, zeros
from tests.both_modes import arrays, assert_same, needs_both, sibling

LINKS = [
    0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.25, 1.0,
]  # fmt: skip


def test_segments_are_placed_with_their_links():
    shapes = doubles([0.1, 0.0, 0.0, 0.0, 0.2, 0.3, 0.05] * 2)
    segments = zeros(12)
    place_segments(shapes, indices([-1, 0]), doubles(LINKS), segments)

    assert segments[:6].tolist() == [0.1, 0.0, 0.0, 0.0, 0.2, 0.3]
    assert segments[6:].tolist() == pytest.approx([0.5, 0.1, 0.25, 0.3, 0.0, 0.55])


def test_the_closest_of_the_pairs_is_found():
    shapes = doubles([0.0] * 6 + [0.1] + [0.0] * 6 + [0.2] + [0.0] * 6 + [0.3])
    segments = doubles([0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 1, 0, 0, 1.5, 1, 0, 1.5])
    found = zeros(7)

    def nearest(pairs):
        return capsules.nearest_pair(shapes, segments, indices(pairs), found)

    assert nearest([0, 1, 0, 2, 1, 2]) == 2
    assert found[0] == pytest.approx(0.5 - 0.5)
    assert nearest([0, 1, 0, 2]) == 0
    assert found[0] == pytest.approx(1.0 - 0.3)
    assert nearest([]) == -1
    assert found[0] == float("inf")


@needs_both
@settings(max_examples=60)
@given(arrays(21), arrays(32))
def test_both_modes_agree_bit_for_bit(shapes, links):
    def scenario(module):
        shapes_, segments, found = doubles(shapes), zeros(18), zeros(7)
        sibling(module, "distances").place_segments(
            shapes_, indices([-1, 0, 1]), doubles(links), segments
        )
        pairs = indices([0, 1, 0, 2, 1, 2])
        number = module.nearest_pair(shapes_, segments, pairs, found)
        return [float(number), found[0], *segments]

    assert_same("capsules", scenario)
