"""Desired motion: holding, following, and never jumping."""

from math import inf

import pytest

from station.hw.franka.simulated.desired_motion import DesiredMotion

PERIOD = 0.001


def make(
    q_d: float, dq_d: float = 0.0, *, lower: float = -inf, upper: float = inf
) -> tuple[DesiredMotion, list[float], list[float], list[float]]:
    lists = [q_d], [dq_d], [0.0]
    motion = DesiredMotion(
        *lists, lower=[lower], upper=[upper], deceleration=[10.0], period=PERIOD
    )
    return motion, *lists


@pytest.mark.parametrize("velocity", [0.5, -0.5])
def test_hold_slows_down_at_the_set_rate_and_stays(velocity: float) -> None:
    motion, q_d, dq_d, ddq_d = make(1.0, velocity)
    motion.hold()
    assert abs(ddq_d[0]) == pytest.approx(10.0)
    for _ in range(60):
        motion.hold()
    assert (dq_d, ddq_d) == ([0.0], [0.0])
    assert motion.is_at_rest
    # v^2 / 2a, less half a step's way for the discrete sum.
    way = velocity * abs(velocity) / 20.0
    assert q_d[0] - 1.0 == pytest.approx(way, abs=abs(velocity) * PERIOD)


def test_velocities_are_integrated() -> None:
    motion, q_d, dq_d, _ = make(0.0)
    for _ in range(100):
        motion.follow_velocities([0.2])
    assert q_d == pytest.approx([0.02])
    assert dq_d == [0.2]


def test_velocity_motion_stops_at_a_position_limit_and_comes_back() -> None:
    motion, q_d, dq_d, _ = make(0.9995, upper=1.0)
    for _ in range(10):
        motion.follow_velocities([1.0])
    assert (q_d, dq_d) == ([1.0], [0.0])
    motion.follow_velocities([-1.0])
    assert q_d == pytest.approx([0.999])


def test_joint_outside_its_limits_is_not_pushed_back_by_a_jump() -> None:
    motion, q_d, _, _ = make(1.2, upper=1.0)
    motion.follow_velocities([0.5])
    motion.hold()
    assert q_d == [1.2]


def test_positions_are_taken_over_with_their_differences() -> None:
    motion, q_d, dq_d, ddq_d = make(0.0)
    motion.follow_positions([0.001])
    motion.follow_positions([0.003])
    assert q_d == [0.003]
    assert dq_d == pytest.approx([2.0])
    assert ddq_d == pytest.approx([1000.0])


def test_seed_begins_from_a_measured_motion() -> None:
    motion, q_d, dq_d, ddq_d = make(0.0)
    motion.seed([0.4], [0.1])
    assert (q_d, dq_d, ddq_d) == ([0.4], [0.1], [0.0])
