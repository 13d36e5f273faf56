"""Filter and limiter against a second implementation in NumPy, and the theory of both.

The second implementation has its numbers and formulas from Franka's documentation and
works on arrays, so that the two have nothing in common.
"""

from math import inf

import numpy as np
import pytest

from station.core.numerics.command_rates import CommandRates, filter_commands
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS, ArmLimits
from station.hw.franka.commands.rate_limiter import (
    MARGIN,
    PERIOD,
    low_pass_gain,
    rate_limits_of,
    with_margins,
)
from station.memory.doubles import as_doubles, doubles, zeros
from tests.hw.franka.limited_commands import (
    limit_position,
    limit_twist,
    limit_velocity,
)

SAMPLES = 2_000
EPS = 1e-3
# Joints 1 to 7.
PANDA = {
    "ddq": np.array([15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0]) - EPS,
    "dddq": np.array([7500, 3750, 5000, 6250, 7500, 10000, 10000]) - EPS,
}
FR3 = {"ddq": np.full(7, 10.0) - EPS, "dddq": np.full(7, 5000.0) - EPS}
PANDA_DQ = np.array([2.175] * 4 + [2.61] * 3) - EPS - 3e-3 * PANDA["ddq"]
FR3_V = np.array([2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26])
FR3_A = np.array([0.30, 0.20, 0.20, 0.30, 0.35, 0.35, 0.35])
FR3_B = np.array([12.0, 5.17, 7.0, 8.0, 34.0, 11.0, 34.0])
FR3_UP = np.array([2.7501, 1.7918, 2.9065, -0.1458, 2.8101, 4.5205, 3.0196])
FR3_LOW = np.array([-2.7501, -1.7918, -2.9065, -3.0481, -2.8101, 0.54092, -3.0196])


def velocity_bounds(arm: str, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    if arm == "panda":
        return -PANDA_DQ, PANDA_DQ
    up = np.sqrt(np.clip(FR3_B * (FR3_UP - q), 0.0, None)) - FR3_A
    down = np.sqrt(np.clip(FR3_B * (q - FR3_LOW), 0.0, None)) - FR3_A
    return -np.clip(down, 0, FR3_V) + EPS, np.clip(up, 0, FR3_V) - EPS


def limited_velocity(arm: str, v: np.ndarray, q: np.ndarray, v0: np.ndarray, a0):
    """Return all joints' limited velocities, by the formulas of the documentation."""
    limits = PANDA if arm == "panda" else FR3
    low, high = velocity_bounds(arm, q)
    acceleration = np.clip(
        (v - v0) / PERIOD,
        a0 - limits["dddq"] * PERIOD,
        a0 + limits["dddq"] * PERIOD,
    )
    slope = limits["dddq"] / limits["ddq"]
    largest = np.minimum(slope * (high - v0), limits["ddq"])
    smallest = np.maximum(slope * (low - v0), -limits["ddq"])
    return v0 + np.maximum(np.minimum(acceleration, largest), smallest) * PERIOD


@pytest.mark.parametrize(
    ("arm", "limits"), [("panda", PANDA_LIMITS), ("fr3", FR3_LIMITS)]
)
def test_joint_motions_are_limited_alike(arm: str, limits: ArmLimits) -> None:
    generator = np.random.default_rng(8)
    rates = rate_limits_of(limits)
    for _ in range(SAMPLES):
        # Inside, where the range of velocities is wider than its margins.
        q = generator.uniform(
            np.array(limits.lower) + 0.1, np.array(limits.upper) - 0.1
        )
        low, high = velocity_bounds(arm, q)
        v0 = generator.uniform(low, high)
        a0 = generator.uniform(-10.0, 10.0, 7)
        v = v0 + generator.normal(size=7) * 10.0 ** generator.uniform(-5, 0)
        expected = limited_velocity(arm, v, q, v0, a0)
        for i, rate in enumerate(rates):
            allowed = None
            if limits.curves:
                slowest, fastest = limits.velocity_range(i, q[i])
                allowed = min(0.0, slowest + 1e-3), max(0.0, fastest - 1e-3)
            start = (v0[i], a0[i], rate, allowed)
            assert limit_velocity(v[i], *start) == pytest.approx(expected[i], abs=1e-12)
            position = limit_position(q[i] + v[i] * PERIOD, q[i], *start)
            # The velocity is a difference of positions of up to 5 rad.
            assert position == pytest.approx(q[i] + expected[i] * PERIOD, abs=1e-12)


def limited_torques(tau: np.ndarray, last: np.ndarray, rate: float) -> list[float]:
    """Return torques as they are sent, with every sample as a joint of its own."""
    size = len(tau)
    free = [np.inf] * size
    rates = CommandRates(
        tau_J_d=as_doubles(last),
        q_d=zeros(size),
        dq_d=zeros(size),
        ddq_d=zeros(size),
        positions=zeros(size),
        velocities=zeros(size),
        efforts=as_doubles(tau),
        velocity=free,
        acceleration=free,
        jerk=free,
        torque_rate=rate,
        lower=[-np.inf] * size,
        upper=free,
        braking_share=0.5,
        approach_gain=50.0,
        period=PERIOD,
    )
    rates.is_limiting = True
    rates.filter_torques()
    return [*rates.result]


def test_torque_rates_are_limited_both_ways() -> None:
    tau = np.array([0.5, 5.0, -5.0, 1.0])
    limited = limited_torques(tau, np.zeros(4), 1000.0)
    assert limited == pytest.approx([0.5, 1.0, -1.0, 1.0])


def test_torque_rates_are_limited_alike() -> None:
    generator = np.random.default_rng(9)
    last = generator.uniform(-87.0, 87.0, SAMPLES)
    tau = last + generator.normal(size=SAMPLES) * 3.0
    step = (1000.0 - EPS) * PERIOD
    expected = np.clip(tau, last - step, last + step)
    rate = PANDA_LIMITS.torque_rate - MARGIN
    np.testing.assert_allclose(
        limited_torques(tau, last, rate), expected, rtol=0.0, atol=1e-12
    )


@pytest.mark.parametrize(
    ("limits", "translation", "rotation", "elbow"),
    [(PANDA_LIMITS, 1.960, 2.424, 2.144), (FR3_LIMITS, 2.999, 2.499, 1.499)],
    ids=["panda", "fr3"],
)
def test_maxima_of_the_end_effector_are_libfrankas(
    limits: ArmLimits, translation: float, rotation: float, elbow: float
) -> None:
    losses = limits.tolerated_losses
    # Published to 3 digits; the margins' products add 3e-6.
    assert with_margins(limits.translation, losses).velocity == pytest.approx(
        translation, abs=5e-6
    )
    assert with_margins(limits.rotation, losses).velocity == pytest.approx(
        rotation, abs=5e-6
    )
    reserve = losses * PERIOD * (limits.elbow.acceleration - EPS)
    assert limits.limiter_elbow_velocity - EPS - reserve == pytest.approx(
        elbow, abs=5e-6
    )


def limited_vector(v: np.ndarray, v0: np.ndarray, a0: np.ndarray, limits) -> np.ndarray:
    """Return a limited twist's half; the room to the sphere of speeds is a root."""
    jerk = ((v - v0) / PERIOD - a0) / PERIOD
    size = np.linalg.norm(jerk)
    a = a0 + jerk * min(1.0, limits.jerk / size) * PERIOD
    size = np.linalg.norm(a)
    direction = a / size
    room = np.roots([1.0, 2.0 * direction @ v0, v0 @ v0 - limits.velocity**2]).max()
    safe = min(limits.jerk / limits.acceleration * room, limits.acceleration)
    return v0 + direction * min(size, safe) * PERIOD


@pytest.mark.parametrize("limits", [PANDA_LIMITS, FR3_LIMITS], ids=["panda", "fr3"])
@pytest.mark.parametrize("part", ["translation", "rotation"])
def test_twists_are_limited_alike(limits: ArmLimits, part: str) -> None:
    generator = np.random.default_rng(10)
    bounds = with_margins(getattr(limits, part), limits.tolerated_losses)
    for _ in range(SAMPLES):
        v0 = generator.normal(size=3)
        v0 *= bounds.velocity * generator.uniform() / np.linalg.norm(v0)
        a0 = generator.normal(size=3)
        a0 *= bounds.acceleration * generator.uniform() / np.linalg.norm(a0)
        v = v0 + generator.normal(size=3) * 10.0 ** generator.uniform(-5, 0)
        ours = limit_twist(v, v0, a0, bounds)
        expected = limited_vector(v, v0, a0, bounds)
        np.testing.assert_allclose(ours, expected, rtol=0.0, atol=1e-12)
        assert np.linalg.norm(ours) <= bounds.velocity + 1e-9
        rate = np.linalg.norm((ours - v0) / PERIOD)
        assert rate <= bounds.acceleration + 1e-9


@pytest.mark.parametrize("cutoff", [10.0, 100.0, 400.0])
@pytest.mark.parametrize("frequency", [5.0, 50.0, 200.0])
def test_low_pass_has_the_response_of_its_transfer_function(
    cutoff: float, frequency: float
) -> None:
    gain = PERIOD / (PERIOD + 1.0 / (2.0 * np.pi * cutoff))
    step = np.exp(2j * np.pi * frequency * PERIOD)
    response = gain / (1.0 - (1.0 - gain) / step)
    value, outputs = zeros(1), []
    for cycle in range(2_000):
        wave = doubles([(step**cycle).real])
        filter_commands(wave, value, low_pass_gain(cutoff), inf, value, 1)
        outputs.append(value[0])
    cycles = np.arange(1_000, 2_000)
    expected = (response * step**cycles).real
    np.testing.assert_allclose(outputs[1_000:], expected, rtol=0.0, atol=1e-9)
