"""Soft limits follow their formulas on both sides of the edge of the free range."""

from math import isnan, nan

from hypothesis import given, settings, strategies as st

from station.core.hardware.limits import limited_joints as joint_limits
from station.core.hardware.limits.limited_joints import LIMITS, MEMORY, free_range
from station.memory.doubles import doubles

VELOCITY, EFFORT, K_VELOCITY, PERIOD = 2.175, 87.0, 40.0, 0.001
WAYS = (-1.0, 1.0)
at_full_speed = st.sampled_from(WAYS)
"""Commands that the largest velocity just allows."""
gains = st.sampled_from([0.1, 1.0, 3.0, 100.0, 1e6])
ends = st.tuples(st.floats(-3.0, 0.0), st.floats(0.0, 3.0))
near = st.sampled_from([0.0, 1e-16, 1e-12, 1e-9, 1e-6, 1e-3, 1.0])


def clip(value, low, high):
    return min(max(value, low), high)


def velocity_bounds(position, low, high, gain):
    """Return the velocities that the ends of a range allow, by their definition."""
    return (
        clip(-gain * (position - low), -VELOCITY, VELOCITY),
        clip(-gain * (position - high), -VELOCITY, VELOCITY),
    )


def views_of(low, high, gain, **values):
    views = {name: doubles([nan]) for name in (*LIMITS, *MEMORY, "asked", "reason")}
    numbers = {
        "soft_min": low,
        "soft_max": high,
        "k_position": gain,
        "min_position": low - 0.1,
        "max_position": high + 0.1,
        "max_velocity": VELOCITY,
        "max_effort": EFFORT,
        "k_velocity": K_VELOCITY,
        **values,
    }
    views.update({name: doubles([value]) for name, value in numbers.items()})
    return views


@st.composite
def places(draw):
    """Return a range, a gain, and a position near an edge of the free range."""
    (low, high), gain = draw(ends), draw(gains)
    away = VELOCITY / gain * (1.0 + draw(near) * draw(at_full_speed))
    position = draw(st.sampled_from([low + away, high - away, (low + high) / 2.0]))
    return low, high, gain, position


@settings(derandomize=True, max_examples=400)
@given(places(), st.floats(-3.0, 3.0), st.floats(-120.0, 120.0) | at_full_speed)
def test_efforts_follow_the_formula_at_the_edge(place, velocity, asked):
    low, high, gain, position = place
    if asked in WAYS:
        asked = -K_VELOCITY * (velocity - asked * VELOCITY)
    views = views_of(low, high, gain, position=position, velocity=velocity)
    views["command"] = doubles([asked])

    joint_limits.EffortSoftLimits(views).enforce(PERIOD, 0, 1)

    slowest, fastest = velocity_bounds(position, low, high, gain)
    least = clip(-K_VELOCITY * (velocity - slowest), -EFFORT, EFFORT)
    most = clip(-K_VELOCITY * (velocity - fastest), -EFFORT, EFFORT)
    assert views["command"][0] == clip(asked, least, most)


@settings(derandomize=True, max_examples=400)
@given(places(), st.floats(-0.003, 0.003) | at_full_speed)
def test_positions_follow_the_formula_at_the_edge(place, step):
    low, high, gain, before = place
    asked = before + (step * VELOCITY * PERIOD if step in WAYS else step)
    views = views_of(low, high, gain, previous=before, position=0.0, velocity=0.0)
    views["command"] = doubles([asked])

    joint_limits.PositionLimits(views).enforce(PERIOD, 0, 1)

    slowest, fastest = velocity_bounds(before, low, high, gain)
    least = max(before + slowest * PERIOD, low - 0.1)
    most = min(before + fastest * PERIOD, high + 0.1)
    assert views["command"][0] == clip(asked, least, most)
    assert views["previous"][0] == views["command"][0]


@settings(derandomize=True)
@given(ends, gains)
def test_the_free_range_allows_the_largest_velocity_and_nearly_all_of_it(end, gain):
    low, high = end
    first, last = free_range(low, high, VELOCITY, gain)

    for edge in (first, last):
        if first <= last:
            assert velocity_bounds(edge, low, high, gain) == (-VELOCITY, VELOCITY)
    closer = first - 2e-9 * (abs(low) + abs(high) + VELOCITY / gain) - 1e-15
    assert -gain * (closer - low) > -VELOCITY


def test_a_joint_without_range_is_free_everywhere_and_one_without_gain_nowhere():
    first, last = free_range(nan, nan, VELOCITY, nan)
    assert (first, last) == (float("-inf"), float("inf"))

    for gain in (0.0, -1.0, nan):
        first, last = free_range(-1.0, 1.0, VELOCITY, gain)
        assert first > last

    assert isnan(free_range(float("-inf"), 1.0, VELOCITY, 1.0)[0])
