"""Noise is the original's sequence, and Gaussian."""

from math import inf, nan
from statistics import mean, pstdev

import pytest

from station.core.errors import InvalidGainError
from station.core.toolbox.signals import Dither

# What control_toolbox@de05a5c Dither::update returns (g++ 12, libstdc++), amplitude 2.5
RECORDED = {
    0: [
        0.75701305926853479,
        2.8069873519722979,
        0.18260350513447507,
        0.17714809420552971,
        3.8001737477718041,
        -3.5558146046085044,
    ],
    12345: [
        0.1045850728682324,
        1.4877279153914043,
        -0.17980420845098358,
        2.0011167700651957,
        -0.95288942624434803,
        -2.6076722008133277,
    ],
}


@pytest.mark.parametrize("seed", RECORDED)
def test_sequence_is_the_recorded_one(seed):
    dither = Dither(2.5, seed)
    sequence = [dither.update() for _ in RECORDED[seed]]
    # another libm may round a logarithm differently
    assert sequence == pytest.approx(RECORDED[seed], rel=1e-15)


def test_noise_has_the_given_standard_deviation():
    dither = Dither(2.0, seed=1)
    noise = [dither.update() for _ in range(20_000)]
    assert mean(noise) == pytest.approx(0.0, abs=0.06)  # 4 standard errors
    assert pstdev(noise) == pytest.approx(2.0, abs=0.04)  # 4 standard errors


def test_amplitude_of_zero_is_silent():
    dither = Dither(0.0, seed=1)
    assert {dither.update() for _ in range(10)} <= {0.0}


@pytest.mark.parametrize(
    ("amplitude", "seed"), [(-1.0, 0), (nan, 0), (inf, 0), (1.0, -1), (1.0, 1 << 32)]
)
def test_impossible_settings_are_refused(amplitude, seed):
    with pytest.raises(InvalidGainError, match=r"amplitude is|seed is"):
        Dither(amplitude, seed)
