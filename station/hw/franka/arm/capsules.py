"""Distances between capsules that are fixed to the links of an arm.

A capsule is a segment with a radius. It has 7 numbers, the ends of its segment in the
frame of its link [m] and the radius [m].
"""

from station.core.geometry.distances import nearest_points, place_segments
from station.memory.doubles import Doubles, Indices, Storage, zeros


class LinkDistances:
    """Finds the closest two of some capsules that are fixed to the links of an arm.

    Args:
        capsules: The capsules, 7 numbers each.
        owners: For each capsule the index of its link; -1 for the base.
        pairs: Indices of both capsules of each pair to compare.

    Attributes:
        closest: Number of the closest pair: the index of its first capsule times the
            number of all capsules, plus the index of the second one.
    """

    def __init__(self, capsules: Doubles, owners: Indices, pairs: Indices) -> None:
        self.capsules = capsules
        self.owners = owners
        self.pairs = pairs
        self.segments = zeros(6 * len(owners))
        self.found = zeros(7)
        self.closest = -1

    def measure(self, links: Storage) -> float:
        """Return the distance of the closest pair [m]; negative if it overlaps.

        Args:
            links: Poses of the links, 16 numbers each.
        """
        place_segments(self.capsules, self.owners, links, self.segments)
        number = nearest_pair(self.capsules, self.segments, self.pairs, self.found)
        # There is none where a position is not finite.
        if number >= 0:
            first, second = self.pairs[2 * number], self.pairs[2 * number + 1]
            self.closest = first * len(self.owners) + second
        return self.found[0]


def nearest_pair(
    capsules: Doubles, segments: Doubles, pairs: Indices, found: Doubles
) -> int:
    """Return the number of the closest pair of capsules; -1 when there is none.

    Args:
        capsules: The capsules, 7 numbers each.
        segments: Their segments in the base frame, 6 numbers each.
        pairs: Indices of both capsules of each pair to compare.
        found: Receives the distance of the surfaces [m], the first of 7 numbers;
            negative when the capsules overlap, and infinite when there is no pair.
    """
    best, number = float("inf"), -1
    point, normal = found[1:4], found[4:7]
    for pair in range(len(pairs) // 2):
        i, j = pairs[2 * pair], pairs[2 * pair + 1]
        gap = nearest_points(
            segments[6 * i : 6 * i + 6], segments[6 * j : 6 * j + 6], point, normal
        )
        gap = gap - capsules[7 * i + 6] - capsules[7 * j + 6]
        if gap < best:
            best, number = gap, pair
    found[0] = best
    return number
