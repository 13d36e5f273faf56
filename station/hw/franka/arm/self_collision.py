"""How close an arm's links are to each other: distances between capsules.

Source: franka_ros@c11f000 franka_description/robots/common/franka_arm.xacro and
hand.xacro, the coarse collision models; differs: the safety distance is one between two
capsules, a parameter, and is not part of their radii; pairs that their joints keep
apart are left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

from station.hw.franka.arm.franka_kinematics import link_poses

Point = tuple[float, float, float]

_HAND = 8
_EIGHTH_TURN = 0.5**0.5
_HAND_AXIS = (_EIGHTH_TURN, _EIGHTH_TURN, 0.0)  # the hand is turned by -45 degrees
_HAND_HEIGHT = 0.107
# (link; 8 is the hand), centre [m], axis, radius [m], distance of the spheres [m];
# all in the frame of the link, those of the hand in the one of link 7.
_CAPSULES = (
    (0, (-0.075, 0.0, 0.06), (1.0, 0.0, 0.0), 0.06, 0.03),
    (1, (0.0, 0.0, -0.1915), (0.0, 0.0, 1.0), 0.06, 0.283),
    (2, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.06, 0.12),
    (3, (0.0, 0.0, -0.145), (0.0, 0.0, 1.0), 0.06, 0.15),
    (5, (0.0, 0.0, -0.26), (0.0, 0.0, 1.0), 0.06, 0.10),
    (5, (0.0, 0.08, -0.13), (0.0, 0.0, 1.0), 0.025, 0.14),
    (6, (0.0, 0.0, -0.03), (0.0, 0.0, 1.0), 0.05, 0.08),
    (7, (0.0, 0.0, 0.01), (0.0, 0.0, 1.0), 0.04, 0.14),
    (7, (0.06 * _EIGHTH_TURN, 0.06 * _EIGHTH_TURN, 0.082), _HAND_AXIS, 0.03, 0.01),
    (_HAND, (0.0, 0.0, _HAND_HEIGHT + 0.04), _HAND_AXIS, 0.04, 0.10),
    (_HAND, (0.0, 0.0, _HAND_HEIGHT + 0.10), _HAND_AXIS, 0.02, 0.10),
)
# Links that the joints between them let come near each other; links up to two joints
# apart overlap by construction, the others left out stay 9 cm apart in every pose.
_NEAR: dict[int, tuple[int, ...]] = {
    0: (5, 6, 7, _HAND),
    1: (5, 6, 7, _HAND),
    2: (5, 6, 7, _HAND),
    3: (7, _HAND),
    5: (_HAND,),
}


@dataclass(frozen=True, slots=True)
class Clearance:
    """The closest two links.

    Attributes:
        distance: Between the capsules' surfaces [m]; negative when they overlap.
        links: Their names, e.g. `link2 and hand`.
    """

    distance: float
    links: str


def clearance(q: Sequence[float], *, has_hand: bool) -> Clearance:
    """Return how close the closest two links are; about 0.1 ms.

    Args:
        q: Joint positions [rad], shape (7,).
        has_hand: Whether a hand is mounted.
    """
    segments = _segments(q)
    best, pair = float("inf"), (0, 0)
    for i, (link, start, end, radius) in enumerate(segments):
        for other, other_start, other_end, other_radius in segments[i + 1 :]:
            if other not in _NEAR.get(link, ()) or (other == _HAND and not has_hand):
                continue
            gap = _distance(start, end, other_start, other_end) - radius - other_radius
            if gap < best:
                best, pair = gap, (link, other)
    return Clearance(best, f"{_name(pair[0])} and {_name(pair[1])}")


def _segments(q: Sequence[float]) -> list[tuple[int, Point, Point, float]]:
    """Return link, both sphere centres in the base frame, and radius."""
    poses = link_poses(q)
    found = []
    for link, (x, y, z), (ax, ay, az), radius, length in _CAPSULES:
        half = length / 2.0
        ends = [
            (x - half * ax, y - half * ay, z - half * az),
            (x + half * ax, y + half * ay, z + half * az),
        ]
        if link:
            ends = [_place(poses[min(link, 7) - 1], end) for end in ends]
        found.append((link, ends[0], ends[1], radius))
    return found


def _place(pose: Sequence[float], point: Point) -> Point:
    x, y, z = point
    return (
        pose[0] * x + pose[4] * y + pose[8] * z + pose[12],
        pose[1] * x + pose[5] * y + pose[9] * z + pose[13],
        pose[2] * x + pose[6] * y + pose[10] * z + pose[14],
    )


def _distance(p: Point, q: Point, a: Point, b: Point) -> float:
    """Return the distance between the segments pq and ab, both of some length [m]."""
    ux, uy, uz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    vx, vy, vz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    wx, wy, wz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    square = uu * vv - uv * uv
    # Nearest points of the lines, then back onto the segments; parallel ones: any.
    s = _clip((uv * vw - uw * vv) / square) if square > 1e-12 else 0.0
    t = (uv * s + vw) / vv
    if t < 0.0 or t > 1.0:
        t = _clip(t)
        s = _clip((uv * t - uw) / uu)
    x, y, z = wx + s * ux - t * vx, wy + s * uy - t * vy, wz + s * uz - t * vz
    return sqrt(x * x + y * y + z * z)


def _clip(value: float) -> float:
    return max(0.0, min(1.0, value))


def _name(link: int) -> str:
    return "hand" if link == _HAND else f"link{link}"
