"""Bode figures against the closed form of plants whose answer is known.

The plants are stepped exactly (matrix exponential) under a loop of 1 kHz. What they
are compared with is written down over the complex frequency, and solved by bisection.
"""

import cmath
import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from station.trials.excitations import offsets
from station.trials.frequency_response import (
    figures_of,
    frequencies_between,
    joint_response,
    mass_and_damping,
    sine_figures,
)
from station.wire.excitations import Chirp, Multisine, Sine

PERIOD = 1e-3
P, D = 60.0, 12.0
MASS_DAMPER = (0.5, 2.0, 0.0, 0.0)
WITH_DELAY = (0.5, 4.0, 20.0, 0.02)


def plant(omega, mass, damping, stiffness, delay):
    """Return the plant's answer; a sampled command acts half a period late."""
    late = delay + 0.5 * PERIOD
    return cmath.exp(-1j * omega * late) / (
        stiffness - mass * omega**2 + 1j * omega * damping
    )


def controller(omega):
    """Return the answer of p * e + d * (difference of e) / period."""
    return P + D * (1.0 - cmath.exp(-1j * omega * PERIOD)) / PERIOD


def simulate(motion, duration, system, noise=0.0):
    """Return set-point, position and command of the loop around a plant."""
    mass, damping, stiffness, delay = system
    rates = np.array([[0.0, 1.0, 0.0], [-stiffness / mass, -damping / mass, 1 / mass]])
    step = expm(np.vstack((rates, np.zeros(3))) * PERIOD)
    count, late = round(duration / PERIOD), round(delay / PERIOD)
    times = np.arange(count) * PERIOD
    desired = offsets(motion, times, duration)
    random = np.random.default_rng(3)
    position, output = np.zeros(count), np.zeros(count)
    state, before = np.zeros(2), 0.0
    for k in range(count):
        position[k] = state[0] + noise * random.standard_normal()
        error = desired[k] - position[k]
        output[k] = P * error + D * (error - before) / PERIOD
        before = error
        force = output[k - late] if k >= late else 0.0
        state = (step @ np.append(state, force))[:2]
    return {"desired": desired, "position": position, "output": output}


def closed_form(system):
    """Return bandwidth, margins and crossovers of the loop, by bisection."""

    def loop(f):
        omega = 2.0 * math.pi * f
        return controller(omega) * plant(omega, *system)

    def closed(f):
        return abs(loop(f) / (1.0 + loop(f)))

    crossover = brentq(lambda f: abs(loop(f)) - 1.0, 0.5, 40.0)
    found = {
        "gain_crossover": crossover,
        "phase_margin": 180.0 + math.degrees(cmath.phase(loop(crossover))),
        "bandwidth": brentq(lambda f: closed(f) - math.sqrt(0.5), crossover, 40.0),
    }
    if system[3]:
        turn = brentq(lambda f: loop(f).imag, crossover, 15.0)
        found |= {"phase_crossover": turn, "gain_margin": 1.0 / abs(loop(turn))}
    return found


CHIRP = Chirp(joint="j", amplitude=0.02, first=0.3, last=30.0)


@pytest.mark.parametrize("system", [MASS_DAMPER, WITH_DELAY], ids=["mass", "delay"])
@pytest.mark.parametrize("noise", [0.0, 2e-6])
def test_a_chirp_gives_the_figures_of_the_closed_form(system, noise):
    signals = simulate(CHIRP, 8.0, system, noise)

    response = joint_response(signals, PERIOD, frequencies_between(0.3, 30.0))
    found = figures_of(response)

    for name, value in closed_form(system).items():
        assert found[name] == pytest.approx(value, rel=0.02), name
    assert found["coherence"] > 0.98
    for i, f in enumerate(response.frequency):
        expected = plant(2.0 * math.pi * f, *system)
        assert response.plant.gain[i] == pytest.approx(abs(expected), rel=0.03)


def test_a_mass_damper_has_its_mass_and_its_damping():
    signals = simulate(CHIRP, 8.0, MASS_DAMPER)
    response = joint_response(signals, PERIOD, frequencies_between(0.3, 10.0))

    found = mass_and_damping(response)

    assert found["inertia"] == pytest.approx(0.5, rel=0.02)
    assert found["damping"] == pytest.approx(2.0, rel=0.02)


def test_a_plant_that_is_no_mass_damper_has_no_mass():
    signals = simulate(CHIRP, 8.0, (0.5, 4.0, 400.0, 0.02))
    response = joint_response(signals, PERIOD, frequencies_between(0.3, 10.0))
    assert mass_and_damping(response) == {}


def test_a_multisine_gives_the_answer_at_its_frequencies():
    lines = (0.5, 1.0, 2.0, 4.0, 7.0)
    motion = Multisine(joint="j", amplitude=0.05, frequencies=lines)
    signals = simulate(motion, 8.0, WITH_DELAY, noise=1e-6)

    response = joint_response(signals, PERIOD, lines)

    assert response.frequency == pytest.approx(lines, rel=0.02)
    for i, f in enumerate(lines):
        omega = 2.0 * math.pi * f
        loop = controller(omega) * plant(omega, *WITH_DELAY)
        expected = loop / (1.0 + loop)
        assert response.closed_loop.gain[i] == pytest.approx(abs(expected), rel=0.02)
        degrees = math.degrees(cmath.phase(expected))
        assert response.closed_loop.phase[i] == pytest.approx(degrees, abs=1.5)


def test_a_part_that_does_not_begin_at_rest_is_tapered():
    signals = simulate(CHIRP, 8.0, WITH_DELAY)
    part = {name: values[1500:6500] for name, values in signals.items()}

    response = joint_response(part, PERIOD, frequencies_between(9.0, 20.0))

    for i, f in enumerate(response.frequency):
        expected = plant(2.0 * math.pi * f, *WITH_DELAY)
        assert response.plant.gain[i] == pytest.approx(
            abs(expected), rel=0.06
        )  # what leaks


def test_a_sine_has_gain_and_phase():
    signals = simulate(Sine(joint="j", amplitude=0.05, frequency=3.0), 4.0, WITH_DELAY)

    steady = (signals[name][1500:3450] for name in ("desired", "position"))
    found = sine_figures(*steady, PERIOD, 3.0)

    omega = 6.0 * math.pi
    loop = controller(omega) * plant(omega, *WITH_DELAY)
    expected = loop / (1.0 + loop)
    assert found["gain"] == pytest.approx(abs(expected), rel=0.005)
    assert found["phase"] == pytest.approx(math.degrees(cmath.phase(expected)), abs=0.5)


def test_noise_alone_is_not_coherent_and_has_no_margins():
    random = np.random.default_rng(1)
    names = ("desired", "position", "output")
    signals = {name: random.standard_normal(4000) for name in names}

    found = figures_of(joint_response(signals, PERIOD, frequencies_between(2.0, 100.0)))

    assert found["coherence"] < 0.3
    assert "gain_margin" not in found


def test_a_record_that_is_too_short_or_still_has_no_response():
    still = {name: np.zeros(500) for name in ("desired", "position", "output")}
    assert joint_response(still, PERIOD, (1.0, 2.0)) is None
    short = {name: values[:10] for name, values in still.items()}
    assert joint_response(short, PERIOD, (1.0,)) is None
