"""The sweep is the original's, runs through its frequencies, and ends."""

from math import nan, pi

import pytest

from station.core.errors import InvalidGainError
from station.core.toolbox.signals import SineSweep

# A*sin(K*(exp(t/L) - 1)) of control_toolbox@de05a5c SineSweep, compiled with g++ 12:
# 0.5 to 20 Hz in 10 s with amplitude 3.
RECORDED = {
    0.0: 0.0,
    0.3: 2.5188975343669915,
    2.5: 0.98580440540844894,
    7.123: 1.6995621939505849,
    10.0: -2.292430232452368,
}


@pytest.mark.parametrize("time", RECORDED)
def test_values_are_the_recorded_ones(time):
    sweep = SineSweep(0.5, 20.0, 10.0, 3.0)
    # the argument is near 300 rad: one rounding there is 3e-14 of the phase
    assert sweep.update(time) == pytest.approx(RECORDED[time], abs=3e-13)


@pytest.mark.parametrize(("start", "frequency"), [(0.0, 0.5), (9.999999, 20.0)])
def test_frequency_rises_from_the_first_to_the_last(start, frequency):
    sweep = SineSweep(0.5, 20.0, 10.0, 1.0)
    step = 1e-6
    values = [sweep.update(start - step * (start > 0) + k * step) for k in range(2)]
    slope = (values[1] - values[0]) / step
    cosine = (1.0 - values[0] ** 2) ** 0.5
    assert abs(slope) == pytest.approx(2.0 * pi * frequency * cosine, rel=1e-2)


def test_nothing_follows_the_end():
    assert SineSweep(0.5, 20.0, 10.0, 3.0).update(10.001) == 0.0


@pytest.mark.parametrize(
    "settings",
    [
        (0.0, 1.0, 1.0, 1.0),
        (2.0, 1.0, 1.0, 1.0),
        (1.0, 1.0, 1.0, 1.0),
        (1.0, 2.0, 0.0, 1.0),
        (1.0, 2.0, 1.0, -1.0),
        (1.0, nan, 1.0, 1.0),
    ],
)
def test_impossible_sweeps_are_refused(settings):
    with pytest.raises(InvalidGainError, match="is not possible"):
        SineSweep(*settings)
