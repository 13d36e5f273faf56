"""Metrics against closed forms."""

import math

import numpy as np
import pytest

from station.core.hardware.robot_report import JointLimits, JointLimitsReport
from station.trials.metrics import Counts, measure
from station.trials.trace import Trace
from station.trials.trial import Script
from station.wire.excitations import Step

TIME = np.arange(3000) * 1e-3


def make_trace(position, *, effort=None, error=None):
    position = np.asarray(position)[:, None]
    velocity = np.gradient(position[:, 0], 1e-3)[:, None]
    zeros = np.zeros_like(position)
    return Trace(
        ("j",),
        1e-3,
        TIME,
        position,
        velocity,
        zeros + (0.0 if effort is None else effort),
        zeros,
        zeros if error is None else np.asarray(error)[:, None],
        zeros,
    )


def second_order(damping, rate):
    """Return the step response of a damped oscillator."""
    damped = rate * math.sqrt(1.0 - damping**2)
    decay = np.exp(-damping * rate * TIME)
    phase = damping / math.sqrt(1.0 - damping**2)
    return 1.0 - decay * (np.cos(damped * TIME) + phase * np.sin(damped * TIME))


SCRIPT = Script(
    controller="arm", duration=3.0, commands=(Step(joint="j", amplitude=0.5),)
)


def test_step_response_of_a_second_order_system():
    found = measure(make_trace(0.5 * second_order(0.5, 10.0)), SCRIPT)

    # exp(-pi zeta / sqrt(1 - zeta^2)), and the well-known 1.66 / rate from 10 to 90 %.
    assert found["overshoot"] == pytest.approx(
        math.exp(-math.pi * 0.5 / 0.75**0.5), abs=1e-3
    )
    assert found["rise_time"] == pytest.approx(0.164, abs=2e-3)
    assert found["settling_time"] == pytest.approx(4.0 / 5.0, abs=0.05)


def test_step_that_does_not_arrive_has_no_rise_and_settling_time():
    found = measure(make_trace(0.5 * 0.5 * TIME / TIME[-1]), SCRIPT)

    assert not {"rise_time", "settling_time"} & set(found)
    assert found["overshoot"] == 0.0


def test_error_effort_energy_and_jerk_of_a_sine():
    wave = np.sin(2.0 * math.pi * TIME)
    trace = make_trace(0.1 * wave, effort=3.0, error=0.02 * wave)

    found = measure(trace, Script(controller="arm", duration=3.0))

    assert found["rms_error"] == pytest.approx(0.02 / math.sqrt(2.0), rel=1e-3)
    assert found["largest_error"] == pytest.approx(0.02, rel=1e-3)
    assert found["effort_rms"] == found["effort_peak"] == 3.0
    # Torque 3 Nm over a way of 4 times 0.1 rad in each of 3 periods.
    assert found["energy"] == pytest.approx(3.0 * 0.4 * 3, rel=1e-2)
    jerk = 0.1 * (2.0 * math.pi) ** 3 / math.sqrt(2.0)
    assert found["jerk_rms"] == pytest.approx(jerk, rel=2e-2)
    assert "overshoot" not in found


def test_margin_and_violations_of_limits():
    limits = JointLimits(min_position=-1.0, max_position=0.5, max_velocity=0.6)
    report = JointLimitsReport("j", limits, None, {})
    trace = make_trace(0.1 * np.sin(2.0 * math.pi * TIME))

    found = measure(trace, SCRIPT, [report], Counts(reflexes=1, violations=2))

    assert found["limit_margin"] == pytest.approx(0.4, abs=1e-6)
    assert found["reflexes"] == 1.0
    # The speed 0.2 pi |cos| is above 0.6 in this share of the time.
    share = math.acos(0.6 / (0.2 * math.pi)) / (0.5 * math.pi)
    assert found["violations"] - 2 == pytest.approx(3000 * share, rel=0.02)
