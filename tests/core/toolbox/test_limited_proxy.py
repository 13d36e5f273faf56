"""Efforts are the original's, and the proxy neither winds up nor overshoots."""

from itertools import pairwise
from math import inf, nan

import pytest

from station.core.errors import InvalidGainError
from station.core.toolbox.limited_proxy import LimitedProxy, LimitedProxyGains

# Desired position, velocity, acceleration, then measured position and velocity.
STEPS = [
    (0.5, 0.1, 1.0, 0.1, -0.2),
    (0.5, 0.1, 0.0, 0.11, 0.3),
    (2.0, 0.0, 0.0, 0.2, 0.5),
    (-3.0, 0.0, 0.0, 0.4, 1.0),
    (-3.0, 0.0, 0.0, 0.3, -1.0),
    (0.1, 0.0, -1.0, 0.1, 0.0),
]
# What control_toolbox@de05a5c LimitedProxy::update returns (g++ 12) for these steps of
# 10 ms after reset(0.1, -0.2), with whole-number gains, which it does not truncate.
RECORDED = [
    (
        (2, 20, 200, 50, 5, 10, 1, 20, 5),
        [10.0, 10.0, 8.3097860506204739, -10.0, -10.0, -10.0],
    ),
    (
        (0, 20, 200, 50, 1, 10, 1, 20, 5),
        [1.8905454545454536, -6.1291900826446275, -10.0, -10.0, 10.0, 10.0],
    ),
    (
        (0, 0, 200, 50, 5, 10, 0, 20, 5),
        [
            -0.038548760582565629,
            -1.1206166274106542,
            -10.0,
            -10.0,
            9.4834593053941969,
            10.0,
        ],
    ),
    ((2, 20, 200, 0, 0, 0, 0, 0, 0), [88.0, 74.0, 350.0, -700.0, -640.0, -2.0]),
    ((1, 0, 0, 0, 0, 3, 2, 1000, 4), [3.0, 3.0, 3.0, -3.0, -3.0, 3.0]),
]


@pytest.mark.parametrize(("gains", "efforts"), RECORDED)
def test_efforts_are_the_recorded_ones(gains, efforts):
    proxy = LimitedProxy(LimitedProxyGains(*gains))
    proxy.reset(0.1, -0.2)
    computed = [proxy.update(s[:3], s[3], s[4], 0.01) for s in STEPS]
    # sums are taken in another order, and errors cancel large positions
    assert computed == pytest.approx(efforts, rel=1e-12, abs=1e-12)


GAINS = LimitedProxyGains(
    mass=1.0,
    kd=20.0,
    kp=100.0,
    ki=10.0,
    i_clamp=1.0,
    effort_limit=5.0,
    velocity_limit=1.0,
    bandwidth=20.0,
    acceleration=2.0,
)


def simulate(target, cycles, *, blocked_for=0):
    """Move a body of 1 kg, held fast at first; return its positions."""
    proxy = LimitedProxy(GAINS)
    proxy.reset(0.0, 0.0)
    position = velocity = 0.0
    positions = []
    for cycle in range(cycles):
        effort = proxy.update((target, 0.0, 0.0), position, velocity, 0.001)
        assert abs(effort) <= GAINS.effort_limit
        if cycle >= blocked_for:
            velocity += effort * 0.001
            position += velocity * 0.001
        positions.append(position)
    return positions


def test_target_is_reached_within_the_velocity_limit_and_without_overshoot():
    positions = simulate(1.0, 6000)
    steps = [b - a for a, b in pairwise(positions)]
    assert positions[-1] == pytest.approx(1.0, abs=1e-3)
    assert max(positions) < 1.001
    assert max(steps) <= 0.001 * 1.05  # the controller tracks the proxy to 5 %


@pytest.mark.parametrize("blocked_for", [1000, 5000])
def test_block_leaves_no_more_than_the_clamped_integral(blocked_for):
    positions = simulate(1.0, blocked_for + 6000, blocked_for=blocked_for)
    assert max(positions) <= 1.0 + GAINS.i_clamp / GAINS.kp


@pytest.mark.parametrize(
    "wrong", [{"kp": -1.0}, {"mass": nan}, {"effort_limit": inf}, {"bandwidth": 1.0}]
)
def test_impossible_gains_are_refused(wrong):
    with pytest.raises(InvalidGainError, match=next(iter(wrong))):
        LimitedProxyGains(**wrong)
