"""Figures of a response, against the closed form of a second-order system."""

import numpy as np
import pytest

from station.ui.response_metrics import step_metrics, tracking_metrics


def _second_order(time, damping, frequency):
    """Return the unit step response of an underdamped second-order system."""
    root = np.sqrt(1.0 - damping**2)
    phase = np.arccos(damping)
    angle = frequency * root * time + phase
    return 1.0 - np.exp(-damping * frequency * time) / root * np.sin(angle)


def test_a_second_order_step_has_the_figures_of_the_textbook():
    time = np.linspace(0.0, 5.0, 50_001)
    damping, frequency = 0.5, 10.0
    actual = 0.2 + 0.1 * _second_order(time, damping, frequency)
    told = step_metrics(time, actual, np.full_like(time, -3.0), 0.2, 0.3)
    overshoot = np.exp(-np.pi * damping / np.sqrt(1.0 - damping**2))
    assert told.overshoot == pytest.approx(overshoot, rel=1e-3)
    # Rise from 10 % to 90 % of this damping, by numerical solution: 1.638 / frequency.
    assert told.rise == pytest.approx(0.1638, rel=0.01)
    assert told.settling == pytest.approx(0.808, rel=0.02)
    assert told.steady_error == pytest.approx(0.0, abs=1e-6)
    assert told.peak_output == 3.0


def test_a_step_down_has_the_same_figures_as_one_up():
    time = np.linspace(0.0, 2.0, 2001)
    answer = _second_order(time, 0.4, 12.0)
    up = step_metrics(time, 0.1 * answer, answer, 0.0, 0.1)
    down = step_metrics(time, -0.1 * answer, answer, 0.0, -0.1)
    assert (up.rise, up.overshoot, up.settling) == (
        pytest.approx(down.rise),
        pytest.approx(down.overshoot),
        pytest.approx(down.settling),
    )


def test_what_never_arrives_has_no_rise_and_does_not_settle():
    time = np.linspace(-0.1, 1.0, 111)
    told = step_metrics(time, 0.05 * np.ones(111), np.zeros(111), 0.0, 0.1)
    assert told.rise is None
    assert told.settling is None
    assert told.steady_error == pytest.approx(0.05)


def test_tracking_of_a_sine_has_the_error_of_its_lag():
    time = np.linspace(0.0, 2.0, 20_001)
    desired = 0.1 * np.sin(2.0 * np.pi * time)
    actual = 0.1 * np.sin(2.0 * np.pi * time - 0.1)
    told = tracking_metrics(desired, actual, desired)
    # The difference of two sines is one of amplitude 2 A sin(lag / 2).
    expected = 2.0 * 0.1 * np.sin(0.05) / np.sqrt(2.0)
    assert told.rms_error == pytest.approx(expected, rel=1e-3)
