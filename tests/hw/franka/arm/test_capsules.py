"""Distances between segments against a fine search, and both modes."""

import pytest
from hypothesis import given, settings

from station.core.geometry.distances import place_segments
from station.hw.franka.arm import capsules
from station.memory.doubles import doubles, indices, zeros
from tests.both_modes import arrays, assert_same, needs_both

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
    shapes = [0, 0, 0, 1, 0, 0, 0.1, 0, 0, 1, 1, 0, 1, 0.2, 0, 0, 1.5, 1, 0, 1.5, 0.3]

    def nearest(pairs):
        owners = indices([-1] * 3)
        links = capsules.LinkDistances(doubles(shapes), owners, indices(pairs))
        return links.measure(doubles(LINKS)), links.closest

    assert nearest([0, 1, 0, 2, 1, 2]) == (pytest.approx(0.5 - 0.5), 1 * 3 + 2)
    assert nearest([0, 1, 0, 2]) == (pytest.approx(1.0 - 0.3), 0 * 3 + 1)
    assert nearest([]) == (float("inf"), -1)


@needs_both
@settings(max_examples=60)
@given(arrays(21), arrays(32))
def test_both_modes_agree_bit_for_bit(shapes, links):
    def scenario(module):
        owners, pairs = indices([-1, 0, 1]), indices([0, 1, 0, 2, 1, 2])
        distances = module.LinkDistances(doubles(shapes), owners, pairs)
        return [distances.measure(doubles(links)), float(distances.closest)]

    assert_same("capsules", scenario)
