"""The signals of a script over time."""

import numpy as np
import pytest

from station.trials.excitations import offsets
from station.wire.excitations import (
    Chirp,
    Multisine,
    Recorded,
    Relay,
    Sine,
    Step,
    Waypoints,
)

TIMES = np.arange(4001) * 1e-3
J = "j"
SMOOTH = [
    Sine(joint=J, amplitude=0.2, frequency=1.0),
    Chirp(joint=J, amplitude=0.2, first=0.5, last=3.0),
    Multisine(joint=J, amplitude=0.2, frequencies=(0.5, 1.0, 2.0)),
    Waypoints(joint=J, times=(2.0, 4.0), values=(0.2, 0.0)),
]


@pytest.mark.parametrize("motion", SMOOTH, ids=lambda m: m.kind)
def test_smooth_motions_begin_and_end_at_rest_within_their_amplitude(motion):
    values = offsets(motion, TIMES, 4.0)

    assert abs(values).max() <= 0.2 + 1e-12
    assert abs(values).max() > 0.1
    speed = np.gradient(values, 1e-3)
    assert values[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert speed[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-5)


def test_sine_has_its_frequency():
    values = offsets(Sine(joint=J, amplitude=1.0, frequency=2.0), TIMES, 4.0)

    middle = values[1000:3000]  # two seconds after the fade: four periods
    crossings = np.flatnonzero((middle[:-1] < 0.0) & (middle[1:] >= 0.0))
    assert np.diff(crossings) == pytest.approx([500] * 3, abs=1)


def test_chirp_ends_at_its_last_frequency():
    values = offsets(Chirp(joint=J, amplitude=1.0, first=1.0, last=5.0), TIMES, 4.0)

    crossings = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    periods = np.diff(crossings) * 1e-3
    # The frequency at the middle of the last whole period is 5 Hz less its growth.
    assert 1.0 / periods[-1] == pytest.approx(4.8, abs=0.2)
    assert periods[0] > 2.0 * periods[-1]


def test_step_and_recorded_values_begin_at_their_time():
    step = offsets(Step(joint=J, amplitude=0.5, at=1.0), TIMES, 4.0)
    recorded = Recorded(joint=J, times=(0.5, 1.0), values=(0.1, -0.1))

    assert list(step[[999, 1000]]) == [0.0, 0.5]
    assert list(offsets(recorded, TIMES, 4.0)[[499, 500, 999, 1000]]) == [
        *(0.0, 0.1),
        *(0.1, -0.1),
    ]


def test_relay_waits_for_the_measured_joint():
    assert not offsets(Relay(joint=J, amplitude=0.5), TIMES, 4.0).any()


def test_recorded_values_are_joined_by_a_smooth_curve():
    """Cubic pieces of 20 ms follow a sine of 2 Hz.

    Their slopes are off by h^2/3 of its third derivative at the ends, 0.26 1/s, which a
    piece of h = 20 ms turns into 4/27 h as much between its ends, less than 2e-3.
    """
    knots = np.arange(0.1, 1.1, 0.02)
    wave = np.sin(4.0 * np.pi * (knots - 0.1))
    motion = Recorded(
        joint="j", times=tuple(knots), values=tuple(wave), between="smooth"
    )
    times = np.arange(0.0, 1.2, 0.001)

    found = offsets(motion, times, 1.2)

    inside = (times >= 0.1) & (times <= knots[-1])
    true = np.sin(4.0 * np.pi * (times - 0.1))
    assert np.abs(found - true)[inside].max() < 2e-3
    assert not found[times < 0.1].any()
    assert found[-1] == wave[-1]
    one = Recorded(joint="j", times=(0.1,), values=(0.5,), between="smooth")
    assert offsets(one, times, 1.2)[[0, -1]].tolist() == [0.0, 0.5]
