"""Relay figures against the closed form of plants whose ultimate point is known."""

import cmath
import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from station.trials.relay_tuning import RULES, relay_figures

PERIOD = 1e-3


def oscillate(mass, damping, stiffness, delay, *, hysteresis=0.0, noise=0.0):
    """Return command and position of a plant under a relay of height 1."""
    rates = np.array([[0.0, 1.0, 0.0], [-stiffness / mass, -damping / mass, 1 / mass]])
    step = expm(np.vstack((rates, np.zeros(3))) * PERIOD)
    count, late = 20_000, round(delay / PERIOD)
    random = np.random.default_rng(5)
    output, position = np.zeros(count), np.zeros(count)
    state, side = np.zeros(2), 1.0
    for k in range(count):
        position[k] = state[0] + noise * random.standard_normal()
        if position[k] * side > hysteresis:
            side = -side
        output[k] = side
        force = output[k - late] if k >= late else 0.0
        state = (step @ np.append(state, force))[:2]
    return output, position


def ultimate(mass, damping, stiffness, delay):
    """Return the gain and period at which P alone oscillates, by bisection."""
    late = delay + 0.5 * PERIOD  # a sampled command acts half a period late

    def answer(omega):
        return cmath.exp(-1j * omega * late) / (
            stiffness - mass * omega**2 + 1j * omega * damping
        )

    def imaginary(omega):
        return answer(omega).imag

    low = math.sqrt(stiffness / mass) + 1e-3
    omega = brentq(imaginary, low, math.pi / late)
    return 1.0 / abs(answer(omega)), 2.0 * math.pi / omega


PLANTS = [
    pytest.param((1.0, 1.0, 0.0, 0.02), id="mass-damper"),
    pytest.param((1.0, 2.0, 4.0, 0.1), id="second-order"),
    pytest.param((1.0, 3.0, 2.0, 0.3), id="long-delay"),
]


@pytest.mark.parametrize("plant", PLANTS)
def test_the_ultimate_point_is_that_of_the_closed_form(plant):
    gain, period = ultimate(*plant)

    found = relay_figures(*oscillate(*plant), PERIOD)

    assert found["ultimate_gain"] == pytest.approx(gain, rel=0.02)
    assert found["ultimate_period"] == pytest.approx(period, rel=0.02)


@pytest.mark.parametrize("plant", PLANTS)
def test_hysteresis_and_noise_do_not_bend_the_ultimate_point(plant):
    gain, period = ultimate(*plant)
    amplitude = relay_figures(*oscillate(*plant), PERIOD)["amplitude"]

    signals = oscillate(*plant, hysteresis=0.03 * amplitude, noise=0.002 * amplitude)
    found = relay_figures(*signals, PERIOD)

    assert found["period"] > period
    assert found["ultimate_gain"] == pytest.approx(gain, rel=0.02)
    assert found["ultimate_period"] == pytest.approx(period, rel=0.02)


def test_what_does_not_oscillate_has_no_figures():
    assert relay_figures(np.ones(2000), np.linspace(0.0, 1.0, 2000), PERIOD) == {}
    assert relay_figures(np.ones(5), np.ones(5), PERIOD) == {}


@pytest.mark.parametrize(
    ("rule", "p", "i", "d"),
    [
        # The published tables, for Ku = 10 and Tu = 2 s, as Kp, Kp/Ti and Kp*Td.
        ("ziegler_nichols_p", 5.0, 0.0, 0.0),
        ("ziegler_nichols_pd", 8.0, 0.0, 2.0),
        ("ziegler_nichols_pi", 4.5, 2.7, 0.0),
        ("ziegler_nichols_pid", 6.0, 6.0, 1.5),
        ("tyreus_luyben_pi", 3.125, 0.7102, 0.0),
        ("tyreus_luyben_pid", 4.5455, 1.0331, 1.4430),
        ("some_overshoot", 3.3, 3.3, 2.2),
        ("no_overshoot", 2.0, 2.0, 1.3333),
    ],
)
def test_a_rule_gives_the_gains_of_its_table(rule, p, i, d):
    assert RULES[rule].gains(10.0, 2.0) == pytest.approx(
        {"p": p, "i": i, "d": d}, rel=1e-3
    )


def test_every_rule_has_a_source():
    assert len(RULES) == 8
    assert all(rule.source for rule in RULES.values())
