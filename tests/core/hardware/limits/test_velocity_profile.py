"""Velocities keep to jerk, acceleration, velocity and the way that is left."""

from math import inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from station.core.hardware.limits import ClampReason, JointLimits
from station.core.hardware.limits.velocity_profile import VelocityProfile, approach

positive = st.floats(0.01, 100.0)


@settings(derandomize=True)
@given(distance=positive, rate=positive, period=st.floats(0.0005, 0.05))
def test_approached_bound_is_reached_without_stronger_braking(distance, rate, period):
    left, speed = distance, approach(distance, rate, period)
    for _ in range(50):
        left -= speed * period
        assert left >= -1e-9 * distance  # rounding of 50 subtractions
        following = approach(left, rate, period)
        assert following >= speed - rate * period * (1.0 + 1e-6) - 1e-9 * speed
        speed = following


@pytest.mark.parametrize("distance", [0.0, -1.0])
def test_beyond_the_bound_nothing_is_left(distance):
    assert approach(distance, 1.0, 0.001) == 0.0


def test_without_rate_limit_the_bound_is_reached_in_one_cycle():
    assert approach(2.0, inf, 0.5) == 4.0


@pytest.mark.parametrize(
    ("limits", "asked", "ways", "expected"),
    [
        (JointLimits(), 7.0, (inf, inf), (7.0, None)),
        (JointLimits(max_velocity=2.0), 7.0, (inf, inf), (2.0, ClampReason.VELOCITY)),
        (
            JointLimits(max_acceleration=3.0),
            -7.0,
            (inf, inf),
            (-0.3, ClampReason.ACCELERATION),
        ),
        (JointLimits(max_jerk=5.0), 7.0, (inf, inf), (0.05, ClampReason.JERK)),
        (JointLimits(), 7.0, (inf, 0.2), (2.0, ClampReason.POSITION)),
        (JointLimits(), 7.0, (inf, -0.2), (0.0, ClampReason.POSITION)),
        (JointLimits(), -7.0, (inf, -0.2), (-7.0, None)),
    ],
)
def test_each_limit_acts_and_is_named(limits, asked, ways, expected):
    profile = VelocityProfile(limits)
    velocity = profile.limit(asked, *ways, 0.1)
    assert velocity == pytest.approx(expected[0], abs=1e-15)  # order of operations
    assert profile.reason is expected[1]
