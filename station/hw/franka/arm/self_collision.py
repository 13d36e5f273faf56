"""The distances between the links of an arm, measured between capsules.

Source: franka_ros@c11f000 franka_description/robots/common/franka_arm.xacro and
hand.xacro, the coarse collision models; differs: the safety distance is a parameter,
measured between two capsules, and not part of their radii; pairs of links that the
joints keep apart are left out.
"""

from collections.abc import Sequence

from station.core.numerics.arm_chain import new_links, place_links
from station.hw.franka.arm.capsules import LinkDistances
from station.hw.franka.arm.franka_kinematics import CHAIN, DOF
from station.memory.doubles import doubles, indices, viewed

_HAND = 8
_EIGHTH_TURN = 0.5**0.5
_HAND_AXIS = (_EIGHTH_TURN, _EIGHTH_TURN, 0.0)  # the hand is turned by -45 degrees
_HAND_HEIGHT = 0.107
# (link; 8 is the hand), centre [m], axis, radius [m], distance of the spheres [m]; all
# in the frame of the link, for the hand in the frame of link 7.
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
# Pairs of links that the joints between them let come near each other. Links at most
# two joints apart overlap by construction; other pairs stay 9 cm apart in every pose.
_NEAR: dict[int, tuple[int, ...]] = {
    0: (5, 6, 7, _HAND),
    1: (5, 6, 7, _HAND),
    2: (5, 6, 7, _HAND),
    3: (7, _HAND),
    5: (_HAND,),
}


def _ends_and_radius(
    center: Sequence[float], axis: Sequence[float], radius: float, length: float
) -> list[float]:
    """Return a capsule in the form of `capsules`, 7 numbers."""
    half = length / 2.0
    ends = [
        c + sign * half * a
        for sign in (-1, 1)
        for c, a in zip(center, axis, strict=True)
    ]
    return [*ends, radius]


_LINKS = [link for link, *_ in _CAPSULES]
_SHAPES = doubles(
    value
    for _, center, axis, radius, length in _CAPSULES
    for value in _ends_and_radius(center, axis, radius, length)
)
# The hand is fixed to link 7; in `capsules` the indices of links begin at 0.
_OWNERS = indices(min(link, DOF) - 1 for link in _LINKS)
_PAIRS = [
    (i, j)
    for i, link in enumerate(_LINKS)
    for j, other in enumerate(_LINKS)
    if i < j and other in _NEAR.get(link, ())
]
_ARM_PAIRS = [pair for pair in _PAIRS if _LINKS[pair[1]] != _HAND]


def _name(link: int) -> str:
    return "hand" if link == _HAND else f"link{link}"


LINKS_OF_PAIR = {
    i * len(_LINKS) + j: f"{_name(_LINKS[i])} and {_name(_LINKS[j])}" for i, j in _PAIRS
}
"""Names of two links, e.g. `link2 and hand`, by the number of the capsules' pair."""


def link_distances(*, has_hand: bool) -> LinkDistances:
    """Return an object that measures the distance of the two closest links.

    Args:
        has_hand: Whether a hand is mounted.
    """
    pairs = _PAIRS if has_hand else _ARM_PAIRS
    return LinkDistances(
        _SHAPES, _OWNERS, indices(index for pair in pairs for index in pair)
    )


def clearance(q: Sequence[float], *, has_hand: bool) -> float:
    """Return the distance between the closest two links [m].

    Args:
        q: Joint positions [rad], shape (7,).
        has_hand: Whether a hand is mounted.
    """
    links = new_links(CHAIN)
    place_links(CHAIN, viewed(q), links)
    return link_distances(has_hand=has_hand).measure(links)
