"""Velocities keep to jerk, acceleration, velocity and the way that is left."""

from math import inf

import pytest
from hypothesis import given, settings, strategies as st

from station.core.hardware.limits import limited_joints as codes
from station.core.hardware.limits.limited_joints import LIMITS, MEMORY
from station.core.hardware.limits.rate_limits import (
    VelocityRateLimits,
    approach,
    stoppable,
)
from station.memory.doubles import doubles
from tests.both_modes import both
from tests.core.hardware.limits.joints_of_limits import joints, numbers, play, sizes

positive = st.floats(0.01, 100.0)


@pytest.mark.parametrize("kind", ["PositionRateLimits", "VelocityRateLimits"])
def test_both_modes_agree_to_the_bit(kind):
    interpreted, compiled = (getattr(module, kind) for module in both("rate_limits"))

    @settings(derandomize=True)
    @given(joints(unlimited=inf))
    def compare(case):
        assert play(interpreted, case) == play(compiled, case)

    compare()


def test_both_modes_agree_on_what_can_be_stopped():
    interpreted, compiled = both("rate_limits")

    @settings(derandomize=True)
    @given(numbers, numbers, numbers, sizes, sizes)
    def compare(distance, velocity, acceleration, rate, jerk):
        numbers = (distance, velocity, acceleration, rate, jerk, 0.001)
        assert repr(interpreted.stoppable(*numbers)) == repr(
            compiled.stoppable(*numbers)
        )
        numbers = (distance, rate, 0.001)
        assert repr(interpreted.approach(*numbers)) == repr(compiled.approach(*numbers))

    compare()


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


def test_a_rate_that_cannot_change_must_be_zero_before_a_bound():
    assert approach(2.0, 0.0, 0.5) == 0.0
    assert approach(inf, 0.0, 0.5) == inf
    assert stoppable(2.0, 0.0, 0.0, 0.0, 1.0, 0.5) == 0.0
    assert stoppable(2.0, 0.0, 0.0, 1.0, 0.0, 0.5) == 0.0


@pytest.mark.parametrize(
    ("limits", "asked", "ways", "expected"),
    [
        ({}, 7.0, (inf, inf), (7.0, None)),
        ({"max_velocity": 2.0}, 7.0, (inf, inf), (2.0, codes.VELOCITY)),
        ({"max_acceleration": 3.0}, -7.0, (inf, inf), (-0.3, codes.ACCELERATION)),
        ({"max_jerk": 5.0}, 7.0, (inf, inf), (0.05, codes.JERK)),
        ({}, 7.0, (inf, 0.2), (2.0, codes.POSITION)),
        ({}, 7.0, (inf, -0.2), (0.0, codes.POSITION)),
        ({}, -7.0, (inf, -0.2), (-7.0, None)),
    ],
)
def test_each_limit_acts_and_is_named(limits, asked, ways, expected):
    names = (*MEMORY, "position", "velocity", "command", "asked", "reason")
    views = {name: doubles([0.0]) for name in names}
    views |= {name: doubles([limits.get(name, inf)]) for name in LIMITS}
    velocity = VelocityRateLimits(views).shape(0, asked, *ways, 0.1)
    assert velocity == pytest.approx(expected[0], abs=1e-15)  # order of operations
    reason = views["reason"][0]
    assert (int(reason) if reason >= 0.0 else None) == expected[1]
