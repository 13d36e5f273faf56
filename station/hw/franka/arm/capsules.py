"""Distances between capsules that are fixed to the links of an arm.

A capsule is a segment with a radius. It has 7 numbers, the ends of its segment in the
frame of its link [m] and the radius [m].
"""

from station.core.geometry.distances import nearest_points, place_segments
from station.memory.doubles import Doubles, Indices, Storage, zeros


class LinkDistances:
    """Finds the two closest of some capsules that are fixed to the links of an arm.

    Args:
        capsules: The capsules, 7 numbers each.
        owners: For each capsule the index of its link; -1 for the base.
        pairs: Indices of both capsules of each pair to compare.

    Attributes:
        closest: Number of the closest pair: the index of its first capsule times the
            number of all capsules, plus the index of its second capsule.
    """

    def __init__(self, capsules: Doubles, owners: Indices, pairs: Indices) -> None:
        self.capsules = capsules
        self.owners = owners
        self.pairs = pairs
        self.segments = zeros(6 * len(owners))
        self.point, self.normal = zeros(3), zeros(3)
        self.closest = -1

    def measure(self, links: Storage) -> float:
        """Return the distance of the closest pair [m]; infinite without pairs.

        It is negative if the capsules overlap.

        Args:
            links: Poses of the links, 16 numbers each [-, m].
        """
        segments, capsules, pairs = self.segments, self.capsules, self.pairs
        place_segments(capsules, self.owners, links, segments)
        best = float("inf")
        for pair in range(len(pairs) // 2):
            i, j = pairs[2 * pair], pairs[2 * pair + 1]
            gap = nearest_points(
                segments[6 * i : 6 * i + 6],
                segments[6 * j : 6 * j + 6],
                self.point,
                self.normal,
            )
            gap = gap - capsules[7 * i + 6] - capsules[7 * j + 6]
            # A pair with a position that is not finite is never the closest.
            if gap < best:
                best, self.closest = gap, i * len(self.owners) + j
        return best
