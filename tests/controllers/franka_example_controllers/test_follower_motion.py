"""The follower's targets: aligned slowly, then on the leader's track."""

import numpy as np
import pytest

from station.controllers.franka_example_controllers.teleop_joint_pd_controller import (
    FollowerMotion,
    MotionBounds,
    ramp,
)

PERIOD = 0.001
BOUNDS = MotionBounds(
    np.full(7, 0.8), np.full(7, 2.0), np.full(7, 1.0), np.full(7, 6.0)
)
REST = np.zeros(7)


@pytest.fixture
def motion():
    result = FollowerMotion(np.full(7, 4.3))
    result.begin_alignment(REST, np.full(7, 0.2))
    return result


def align(motion, cycles):
    """Let an ideal follower be where it shall be."""
    for _ in range(cycles):
        motion.update((REST, REST), motion.q, BOUNDS, PERIOD)


def test_alignment_is_slow_and_smooth(motion):
    for _ in range(1_500):
        before = motion.dq
        motion.update((REST, REST), motion.q, BOUNDS, PERIOD)
        assert np.abs(motion.dq).max() <= 0.1 + 1e-12
        assert np.abs(motion.dq - before).max() <= 0.5 * PERIOD + 1e-12

    assert motion.q == pytest.approx(np.full(7, 0.2 - 0.1 * 1.5), abs=0.02)
    assert not motion.is_tracking


def test_aligned_arms_are_on_the_track(motion):
    align(motion, 3_000)

    assert motion.is_tracking
    align(motion, 2_000)
    assert motion.q == pytest.approx(REST, abs=1e-3)


def test_target_follows_the_leader_without_lag_in_the_end(motion):
    align(motion, 5_000)
    speed = 0.3
    for cycle in range(3_000):
        leader = np.full(7, speed * cycle * PERIOD)
        motion.update((leader, np.full(7, speed)), motion.q, BOUNDS, PERIOD)

    assert motion.dq == pytest.approx(np.full(7, speed), abs=1e-3)
    assert motion.q == pytest.approx(leader, abs=1e-3)


def test_target_far_behind_moves_slower(motion):
    align(motion, 5_000)
    far = np.full(7, 1.0)
    for _ in range(900):
        motion.update((far, REST), motion.q, BOUNDS, PERIOD)
        assert np.abs(motion.dq).max() <= 0.8 + 1e-3

    assert motion.dq == pytest.approx(np.full(7, 0.8), abs=1e-3)


def test_cycle_without_duration_moves_nothing(motion):
    motion.update((REST, REST), motion.q, BOUNDS, 0.0)

    assert motion.q == pytest.approx(np.full(7, 0.2))
    assert np.isfinite(motion.dq).all()


@pytest.mark.parametrize(("x", "expected"), [(-9.0, 1.0), (0.5, 2.0), (9.0, 3.0)])
def test_ramp_is_a_smooth_step(x, expected):
    assert ramp(x, 1.0, 3.0, 0.5, 20.0) == pytest.approx(expected)
