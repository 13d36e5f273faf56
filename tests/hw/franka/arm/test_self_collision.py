"""Links that come close are found, and ordinary poses are no such thing."""

from math import pi

import numpy as np
import pytest

from station.core.numerics.arm_chain import new_links, place_links
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.arm.self_collision import (
    LINKS_OF_PAIR,
    clearance,
    link_distances,
)
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.memory.doubles import doubles

SAFE = 0.03


@pytest.mark.parametrize(
    "q",
    [
        INITIAL_POSITIONS,
        (0.0, 0.0, 0.0, -pi / 2, 0.0, pi / 2, pi / 4),
        (0.0, 0.5, 0.0, -2.6, 0.0, 3.0, 0.7),
        (1.5, -1.0, 0.5, -2.0, -0.5, 2.0, 0.0),
    ],
)
def test_ordinary_poses_are_clear(q):
    assert clearance(q, has_hand=True) > 2.0 * SAFE


@pytest.mark.parametrize(
    ("q", "links"),
    [
        ((0.0, 0.0, 0.0, -0.1, 0.0, 0.0, -pi / 4), "link5 and hand"),
        ((0.0, 1.7, 0.0, -3.0, 0.0, 1.6, 0.0), "link0 and link6"),
        ((0.0, -1.7, 0.0, -3.0, 0.0, 0.4, 0.0), "link2 and hand"),
    ],
)
def test_folded_arm_touches_itself(q, links):
    distances, placed = link_distances(has_hand=True), new_links(CHAIN)
    place_links(CHAIN, doubles(q), placed)
    assert distances.measure(placed) < SAFE
    assert LINKS_OF_PAIR[distances.closest] == links


def test_without_a_hand_there_is_more_room():
    q = (0.0, 0.0, 0.0, -0.1, 0.0, 0.0, -pi / 4)
    assert clearance(q, has_hand=False) > clearance(q, has_hand=True)


def test_no_point_comes_closer_faster_than_the_joints_turn():
    generator = np.random.default_rng(3)
    low, high = np.array(PANDA_LIMITS.lower), np.array(PANDA_LIMITS.upper)
    for _ in range(200):
        q = generator.uniform(low, high)
        turn = generator.uniform(-0.02, 0.02, 7)
        before = clearance(q.tolist(), has_hand=True)
        after = clearance((q + turn).tolist(), has_hand=True)
        assert before - after <= 1.3 * np.abs(turn).sum()
