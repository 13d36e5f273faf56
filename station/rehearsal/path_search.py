"""Search for a joint-space path between obstacles: RRT-Connect, then shortcuts.

Source:
    Kuffner and LaValle, RRT-Connect: an efficient approach to single-query path
    planning, ICRA 2000; Geraerts and Overmars, Creating high-quality paths for motion
    planning, IJRR 26 (2007), for the shortcuts.
"""

import time
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Joints = NDArray[np.float64]
"""Positions of joints [rad or m], shape (n,)."""
RESOLUTION = 0.02
"""Largest step of a joint between two checks for collisions [rad or m]; 17 mm at the
end of an arm of 0.85 m."""
_STEP = 0.6
"""Length of one step of a tree, for the joint that moves most [rad or m]."""
_SHORTCUTS = 60


class PathSearch:
    """Searches for paths among poses that `is_clear` allows.

    Args:
        is_clear: Returns whether a pose is free of collisions.
        lower: Lower ends of the joints' ranges [rad or m], shape (n,).
        upper: Upper ends, shape (n,).
        seed: Seed of the random numbers.
    """

    def __init__(
        self,
        is_clear: Callable[[Joints], bool],
        lower: Joints,
        upper: Joints,
        seed: int,
    ) -> None:
        self._is_clear = is_clear
        self._lower = lower
        self._upper = upper
        self._random = np.random.default_rng(seed)

    def find(
        self, start: Joints, goals: Sequence[Joints], deadline: float
    ) -> list[Joints] | None:
        """Return the corners of a path, from the start to one of the goals.

        Args:
            start: First pose, which must be clear.
            goals: Possible last poses, which must be clear; the best ones first.
            deadline: Time at which the search gives up [s, `time.perf_counter`].

        Returns:
            The path; None when none was found in time.
        """
        for goal in goals:
            if self.is_way_clear(start, goal):
                return [start, goal]
        # A tree has its poses, and the index of each pose's parent; a root is its own
        # parent.
        trees = (([start], [0]), ([*goals], [*range(len(goals))]))
        side = 0
        while time.perf_counter() < deadline:
            sample = self._random.uniform(self._lower, self._upper)
            reached = self._grow(trees[side], sample, deadline)
            if reached is not None:
                met = self._connect(trees[1 - side], reached, deadline)
                if met:
                    halves = [_to_root(*tree) for tree in trees]
                    path = [*reversed(halves[0]), *halves[1][1:]]
                    return self._shortened(path, deadline)
            side = 1 - side
        return None

    def is_way_clear(self, one: Joints, other: Joints) -> bool:
        """Return whether the straight line between two poses is clear."""
        count = max(1, int(np.ceil(np.max(np.abs(other - one)) / RESOLUTION)))
        # Check the middle first, then the middles of the halves: this finds a collision
        # sooner.
        return all(
            self._is_clear(one + (other - one) * share) for share in _halves(count)
        )

    def _grow(
        self, tree: tuple[list[Joints], list[int]], wanted: Joints, deadline: float
    ) -> Joints | None:
        """Add a step towards a pose to a tree; return the new pose, None if blocked."""
        poses, parents = tree
        nearest = int(np.argmin(((np.array(poses) - wanted) ** 2).sum(axis=1)))
        way = wanted - poses[nearest]
        far = float(np.max(np.abs(way)))
        reached = wanted if far <= _STEP else poses[nearest] + way * (_STEP / far)
        if time.perf_counter() > deadline:
            return None
        if far == 0.0 or not self.is_way_clear(poses[nearest], reached):
            return None
        poses.append(reached)
        parents.append(nearest)
        return reached

    def _connect(
        self, tree: tuple[list[Joints], list[int]], wanted: Joints, deadline: float
    ) -> bool:
        """Grow a tree towards a pose as far as possible; return whether it arrived."""
        while True:
            reached = self._grow(tree, wanted, deadline)
            if reached is None:
                return False
            if reached is wanted:
                return True

    def _shortened(self, path: list[Joints], deadline: float) -> list[Joints]:
        for _ in range(_SHORTCUTS):
            if len(path) < 3 or time.perf_counter() > deadline:
                break
            at = np.sort(self._random.uniform(0.0, len(path) - 1.0, 2))
            first, last = int(at[0]), int(at[1])
            if first == last:
                continue
            begin = path[first] + (path[first + 1] - path[first]) * (at[0] - first)
            end = path[last] + (path[min(last + 1, len(path) - 1)] - path[last]) * (
                at[1] - last
            )
            if self.is_way_clear(begin, end):
                path = [*path[: first + 1], begin, end, *path[last + 1 :]]
        return self._without_needless(path)

    def _without_needless(self, path: list[Joints]) -> list[Joints]:
        """Leave out corners whose neighbours can be joined by a straight line."""
        k = 1
        while k < len(path) - 1:
            if self.is_way_clear(path[k - 1], path[k + 1]):
                del path[k]
            else:
                k += 1
        return path


def _to_root(poses: list[Joints], parents: list[int]) -> list[Joints]:
    """Return the poses from the newest pose of a tree to the root."""
    at = len(poses) - 1
    found = [poses[at]]
    while parents[at] != at:
        at = parents[at]
        found.append(poses[at])
    return found


def _halves(count: int) -> list[float]:
    """Return 1/count, 2/count … 1, in the order of repeated halving."""
    order = sorted(range(1, count + 1), key=lambda k: -(k & -k))
    return [1.0, *(k / count for k in order if k < count)]
