"""The smooth motion of a pose by itself."""

from math import pi

import pytest

from station.controllers.cartesian_motion.cartesian_limits import (
    ROTATION,
    TRANSLATION,
    CartesianLimits,
)
from station.controllers.cartesian_motion.cartesian_motion_generator import (
    CartesianMotionGenerator,
)
from station.core.numerics.poses import displace

HERE = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0.3, 0, 0.5, 1.0]


@pytest.fixture
def motion():
    generator = CartesianMotionGenerator(CartesianLimits(TRANSLATION, ROTATION))
    generator.start(HERE)
    return generator


def advance(motion, cycles):
    for _ in range(cycles):
        motion.advance(0.001)


def test_a_cartesian_motion_starts_at_rest(motion):
    advance(motion, 10)

    assert motion.motion.is_at_rest()
    assert [*motion.pose] == pytest.approx(HERE, abs=1e-15)


@pytest.mark.parametrize("angle", [0.5, 3.0, pi])
def test_a_target_is_reached_and_rested_at(motion, angle):
    target = displace(HERE, (0.1, 0.0, -0.1), (0.0, angle, 0.0))
    motion.go_to(target)
    advance(motion, 8_000)

    assert [*motion.pose] == pytest.approx(target, abs=1e-9)
    assert motion.motion.is_at_rest()


def test_braking_ends_where_it_was_foretold(motion):
    motion.go_at([0.1, -0.2, 0.0, 0.3, 0.0, -0.5])
    advance(motion, 400)
    end = motion.resting_pose().tolist()
    motion.brake()
    peaks = [0.0] * 6
    foretold = motion.accelerations[6:].tolist()
    for _ in range(1_500):
        advance(motion, 1)
        peaks = [
            max(p, abs(a)) for p, a in zip(peaks, motion.accelerations[:6], strict=True)
        ]

    assert motion.motion.is_at_rest()
    # The axes do not stop at the same time, so the turn is only nearly the same.
    assert [*motion.pose] == pytest.approx(end, abs=2e-3)
    assert peaks == pytest.approx([abs(value) for value in foretold], rel=0.02)


def test_a_step_can_be_taken_back(motion):
    motion.go_at([0.1, 0.0, 0.0, 0.0, 0.0, 0.2])
    advance(motion, 100)
    before = ([*motion.pose], motion.twist.tolist(), motion.accelerations.tolist())
    motion.advance(0.001)
    after = [*motion.pose]
    motion.undo()

    after_undo = ([*motion.pose], motion.twist.tolist(), motion.accelerations.tolist())
    assert after_undo == before
    motion.go_at([0.1, 0.0, 0.0, 0.0, 0.0, 0.2])
    motion.advance(0.001)
    assert [*motion.pose] == pytest.approx(after, abs=1e-15)


def test_a_way_to_rest_that_is_too_fast_is_seen(motion):
    motion.go_at([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])
    advance(motion, 300)
    assert motion.motion.stays_within_speed()
    motion.go_at([0.3, 0.3, 0.0, 0.0, 0.0, 0.0])  # longer than allowed
    advance(motion, 1_500)

    assert not motion.motion.stays_within_speed()


def test_no_time_moves_nothing(motion):
    motion.go_at([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])
    motion.advance(0.0)

    assert [*motion.pose] == HERE
