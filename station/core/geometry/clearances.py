"""Distances of an arm to the solids around it, at a pose and along a line from it.

Between two measurements the gap of a pair shrinks by at most the motion of the arm and
of the solid. So the last gap minus this motion is a bound, and only pairs with a small
bound are measured again: the result is the same as if all pairs were measured.
"""

from collections.abc import Sequence
from math import dist

from station.core.geometry.distances import (
    MARGIN,
    ROW,
    Nearness,
    place_segments,
    reaches,
    reaches_of_tree,
)
from station.core.numerics.arm_chain import TREE_ROW, new_links, place_links, place_tree
from station.memory.doubles import Doubles, doubles, indices, zeros
from station.memory.functions import square_root

_ROW, _MARGIN = ROW, MARGIN  # as C numbers, by the .pxd
_FAR = 1e9
# Longest motion of any point of the arm between two poses that are checked [m].
_STEP = 0.05
_MOST_STEPS = 6
_REFINEMENTS = 5
# Tolerance for rounding [m]: for the gap of a pair that is nearer than its margin, and
# for bounds.
_ROUNDING = 1e-9


class Clearances:
    """Measures an arm against solids. Control thread only.

    A pair is a capsule of the arm and a solid. The gap of a pair is the distance less
    the margin of the solid [m]. The number of a pair is the number of the capsule times
    the count of solids plus the number of the solid.

    Args:
        chain: The arm, see `arm_chain`.
        capsules: Capsules of its links, 7 numbers each.
        owners: Index of the link of each capsule.
        tree: A robot that is not such a chain, see `place_tree`; `chain` then only
            gives the number of joints.
        longest: See `reaches_of_tree`.

    Attributes:
        count, solid_count: Number of capsules and number of solids.
        capsules, owners: As given.
        links, segments: Poses of the links and ends of the capsules' axes, as `place`
            computed them last.
        solids: Rows of `distances`.
        nearness: Result of the last `exact`.
        way: Displacement of the joints [rad], shape (n,), which `free_share` checks.
        slack: Part of the margin that may be lost on this way [m].
        lag: Largest distance of the robot from the checked poses [m], by which the
            margin is enlarged.
        most_steps: Largest number of checked poses on a line.
        gaps: Gaps of all pairs at the last measurement: exact up to the horizon and for
            the nearest pair, lower bounds beyond.
        least: The least of these gaps.
        horizon: Largest gap that `way` can close [m].
        distance: Distance of the pair with the least gap [m].
        pair: Number of the pair with the least gap; -1 for none.
        blocking: The last pair that reached its margin on a line; -1 for none.
    """

    def __init__(
        self,
        chain: Doubles,
        capsules: Sequence[float],
        owners: Sequence[int],
        tree: Sequence[float] = (),
        longest: Sequence[float] = (),
    ) -> None:
        self.chain, self.capsules = chain, doubles(capsules)
        self.owners, self.count = indices(owners), len(owners)
        self.size = size = len(chain) // 4 - 1
        self.tree, self.is_tree = doubles(tree), len(tree) > 0
        self.link_count = size
        parents, joints = [*range(-1, size - 1)], [*range(size)]
        if self.is_tree:
            parents = [int(number) for number in tree[::TREE_ROW]]
            joints = [int(number) for number in tree[1::TREE_ROW]]
            self.link_count = len(parents)
        self.parents, self.joints = indices(parents), indices(joints)
        self.links = new_links(doubles([0.0] * 4 * (self.link_count + 1)))
        self.segments = zeros(6 * self.count)
        self.way, self.at, self.last = zeros(size), zeros(size), zeros(size)
        self.moved = zeros(self.link_count)
        self.reach = doubles(
            reaches_of_tree(self.tree, self.capsules, self.owners, longest)
            if self.is_tree
            else reaches(chain, self.capsules, self.owners)
        )
        self.lag, self.most_steps = 0.0, _MOST_STEPS
        # Half the axis plus the radius: how far a capsule reaches from its middle.
        self.extents = doubles(
            0.5 * dist(self.capsules[k : k + 3], self.capsules[k + 3 : k + 6])
            + self.capsules[k + 6]
            for k in range(0, len(self.capsules), 7)
        )
        self.slack = 0.0
        self.set_solids([], [])

    def set_solids(self, solids: Sequence[float], triangles: Sequence[float]) -> None:
        """Replace all solids by these.

        Args:
            solids: Rows of `distances` in the frame of the base.
            triangles: Their triangles.
        """
        self.solid_count = len(solids) // ROW
        self.solids = doubles(solids)
        self.nearness = Nearness(self.solids, doubles(triangles or [0.0] * 9))
        pairs = max(1, self.count * self.solid_count)
        self.allowed = indices([1] * pairs)
        # No pair has been measured yet.
        self.gaps = doubles([-_FAR] * pairs)
        self.shifts = zeros(max(1, self.solid_count))
        self.least = self.distance = _FAR
        self.pair = self.blocking = -1
        self.horizon = 0.0

    def allow(self, solid: int, capsules: Sequence[bool]) -> None:
        """Set the capsules for which a solid counts.

        Args:
            solid: Number of the solid.
            capsules: For each capsule, whether the solid counts.
        """
        for i, counts in enumerate(capsules):
            self.allowed[i * self.solid_count + solid] = int(counts)

    def put_capsule(
        self, solid: int, place: Doubles, ends: Doubles, radius: float, margin: float
    ) -> None:
        """Move a solid that is a capsule of another arm.

        Args:
            solid: Number of the solid.
            place: Pose of the other arm's base, 16 numbers.
            ends: Ends of the axis in the frame of that base [m], shape (6,).
            radius: Radius [m].
            margin: Distance to keep [m].
        """
        row = self.solids[_ROW * solid : _ROW * solid + _ROW]
        half, px, py, pz = row[14], row[10], row[11], row[12]
        vx, vy, vz = half * row[7], half * row[8], half * row[9]
        x, y, z = ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]
        length = square_root(x * x + y * y + z * z)
        x, y, z = (
            (x / length, y / length, z / length) if length > 0.0 else (0.0, 0.0, 1.0)
        )
        # Any axis across the capsule; this one is never parallel to it.
        ux, uy, uz = (0.0, z, -y) if -0.7 < x < 0.7 else (-z, 0.0, x)
        size = square_root(ux * ux + uy * uy + uz * uz)
        ux, uy, uz = ux / size, uy / size, uz / size
        wx, wy, wz = y * uz - z * uy, z * ux - x * uz, x * uy - y * ux
        cx = 0.5 * (ends[0] + ends[3])
        cy = 0.5 * (ends[1] + ends[4])
        cz = 0.5 * (ends[2] + ends[5])
        row[0], row[13], row[14], row[15] = 1.0, radius, 0.5 * length, 0.0
        row[_MARGIN], row[17], row[18], row[19] = margin, 1.0, 0.0, 0.0
        for k in range(3):
            a, b, c = place[k], place[4 + k], place[8 + k]
            row[1 + k] = a * ux + b * uy + c * uz
            row[4 + k] = a * wx + b * wy + c * wz
            row[7 + k] = a * x + b * y + c * z
            row[10 + k] = a * cx + b * cy + c * cz + place[12 + k]
        half, px, py, pz = row[14], row[10] - px, row[11] - py, row[12] - pz
        vx, vy, vz = half * row[7] - vx, half * row[8] - vy, half * row[9] - vz
        self.shifts[solid] += square_root(px * px + py * py + pz * pz)
        self.shifts[solid] += square_root(vx * vx + vy * vy + vz * vz)

    def place(self, q: Doubles, share: float) -> None:
        """Place the axes of the capsules at a share, 0 to 1, of `way` from a pose."""
        for i in range(self.size):
            self.at[i] = q[i] + share * self.way[i]
        if self.is_tree:
            place_tree(self.tree, self.at, self.links)
        else:
            place_links(self.chain, self.at, self.links)
        place_segments(self.capsules, self.owners, self.links, self.segments)

    def bound(self, capsule: int, solid: int) -> float:
        """Return a lower bound of the distance of a capsule to a solid [m]."""
        k, ends, o = 6 * capsule, self.segments, _ROW * solid
        middle = self.nearness.of_row(
            0.5 * (ends[k] + ends[k + 3]),
            0.5 * (ends[k + 1] + ends[k + 4]),
            0.5 * (ends[k + 2] + ends[k + 5]),
            o,
        )
        return self.solids[o + 17] * middle - self.extents[capsule]

    def exact(self, capsule: int, solid: int) -> float:
        """Return the distance of a capsule to a solid [m]."""
        radius = self.capsules[7 * capsule + 6]
        return self.nearness.to_row(self.segments, 6 * capsule, radius, _ROW * solid)

    def note_motion(self, q: Doubles) -> None:
        """Note how far the points of each link can have moved since the last pose."""
        for i in range(self.size):
            self.at[i] = q[i] - self.last[i]
            self.last[i] = q[i]
        self.add_up(self.at, _ROUNDING)

    def add_up(self, steps: Doubles, first: float) -> float:
        """Sum up how far points of each link may move with steps of the joints.

        Args:
            steps: Steps of the joints [rad or m], shape (n,).
            first: Distance to start each sum with [m].

        Returns:
            The longest distance [m].
        """
        longest = first
        for i in range(self.link_count):
            parent, step = self.parents[i], steps[self.joints[i]]
            total = first if parent < 0 else self.moved[parent]
            total += self.reach[i] * (step if step > 0.0 else -step)
            self.moved[i] = total
            longest = total if total > longest else longest
        return longest

    def measure(self, q: Doubles, horizon: float) -> float:
        """Measure the pairs at a pose, exactly where it matters; return the least gap.

        Args:
            q: Joint positions [rad], shape (n,).
            horizon: Gaps up to this one are measured exactly [m].
        """
        least, first = _FAR, self.pair
        self.note_motion(q)
        self.place(q, 0.0)
        # First the pair that was nearest: most others can then be skipped.
        if first >= 0:
            capsule, solid = first // self.solid_count, first % self.solid_count
            margin = self.solids[_ROW * solid + _MARGIN]
            self.distance = self.exact(capsule, solid)
            least = self.distance - margin
            self.gaps[first] = least
        for capsule in range(self.count):
            moved = self.moved[self.owners[capsule]]
            for solid in range(self.solid_count):
                number = capsule * self.solid_count + solid
                if number == first:
                    continue
                gap = self.gaps[number] - moved - self.shifts[solid]
                if gap > least and gap > horizon:
                    self.gaps[number] = gap
                    continue
                if not self.allowed[number]:
                    self.gaps[number] = _FAR
                    continue
                margin = self.solids[_ROW * solid + _MARGIN]
                gap = self.bound(capsule, solid) - margin
                if gap <= least or gap <= horizon:
                    gap = self.exact(capsule, solid) - margin
                    if gap < least:
                        least = gap
                        self.distance, self.pair = gap + margin, number
                self.gaps[number] = gap
        for solid in range(self.solid_count):
            self.shifts[solid] = 0.0
        self.least = least
        return least

    def blocked_at(self, q: Doubles, share: float) -> int:
        """Return the first pair that is too near at a share of `way`, or -1."""
        self.place(q, share)
        for capsule in range(self.count):
            for solid in range(self.solid_count):
                number = capsule * self.solid_count + solid
                before = self.gaps[number]
                if before > self.horizon:
                    continue
                allowed = before - _ROUNDING if before < self.lag else self.lag
                allowed -= self.slack
                margin = self.solids[_ROW * solid + _MARGIN]
                if self.bound(capsule, solid) - margin > allowed:
                    continue
                if self.exact(capsule, solid) - margin < allowed:
                    return number
        return -1

    def free_share(self, q: Doubles, zone: float) -> float:
        """Return the share of `way`, 0 to 1, on which every pair keeps its margin.

        Args:
            q: Joint positions at which the line begins [rad], shape (n,).
            zone: Distance beyond the horizon up to which gaps are exact [m].
        """
        length = self.add_up(self.way, 0.0)
        self.horizon = length + self.lag
        if self.measure(q, self.horizon + zone) > self.horizon:
            return 1.0
        steps = int(length / _STEP) + 1
        if steps > self.most_steps:
            steps = self.most_steps
        low, high, found = 0.0, 1.0, -1
        for step_number in range(1, steps + 1):
            high = step_number / (1.0 * steps)
            found = self.blocked_at(q, high)
            if found >= 0:
                self.blocking = found
                break
            low = high
        if low >= 1.0:
            return 1.0
        for _ in range(_REFINEMENTS):
            middle = 0.5 * (low + high)
            if self.blocked_at(q, middle) >= 0:
                high = middle
            else:
                low = middle
        return low
