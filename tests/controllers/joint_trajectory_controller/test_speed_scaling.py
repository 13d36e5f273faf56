"""The passage of a trajectory's time."""

import pytest

from station.controllers.joint_trajectory_controller.execution import SpeedScaling


def test_at_full_speed_time_passes_exactly():
    speed = SpeedScaling()
    assert [speed.advance(0.001) for _ in range(3)] == [0.001] * 3


def test_the_factor_ramps_down_and_up():
    speed = SpeedScaling(1.0, ramp_time=0.5)
    speed.target = 0.0
    passed = sum(speed.advance(0.001) for _ in range(500))
    assert speed.factor == pytest.approx(0.0, abs=1e-9)
    # The area of the triangle under the ramp.
    assert passed == pytest.approx(0.25)
    speed.advance(0.001)
    assert speed.advance(0.001) == 0.0
    speed.target = 0.4
    sum(speed.advance(0.001) for _ in range(201))
    assert speed.factor == pytest.approx(0.4)
    assert speed.advance(0.001) == pytest.approx(0.0004)


def test_the_rate_is_that_of_the_ramp():
    speed = SpeedScaling(1.0, ramp_time=0.5)
    speed.target = 0.0
    speed.advance(0.001)
    assert speed.rate == pytest.approx(-2.0)


def test_without_a_ramp_the_factor_jumps():
    speed = SpeedScaling(1.0, ramp_time=0.0)
    speed.target = 0.3
    speed.advance(0.001)
    assert speed.factor == 0.3
