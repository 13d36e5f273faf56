"""Limits of Cartesian motion are within those of the arms, and hold per vector."""

from math import sqrt

import pytest

from station.controllers.cartesian_motion.cartesian_limits import (
    LARGEST_ROTATION,
    LARGEST_TRANSLATION,
    ROTATION,
    TRANSLATION,
    CartesianLimits,
    read_cartesian_limits,
)
from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS


def read(**values):
    return read_cartesian_limits(Parameters(ParameterTree({"it": values}), "it"))


def test_defaults_are_well_within_what_the_arms_allow():
    assert read() == CartesianLimits(TRANSLATION, ROTATION)
    for arm in (PANDA_LIMITS, FR3_LIMITS):
        for name in ("velocity", "acceleration", "jerk"):
            for default, largest, allowed in (
                (TRANSLATION, LARGEST_TRANSLATION, arm.translation),
                (ROTATION, LARGEST_ROTATION, arm.rotation),
            ):
                assert getattr(default, name) <= 0.5 * getattr(largest, name)
                assert getattr(largest, name) <= getattr(allowed, name)


def test_axes_share_the_length_of_a_vector():
    axes = read(max_translational_velocity=0.6, max_rotational_jerk=30.0).of_axes()

    assert sqrt(sum(v * v for v in axes.velocity[:3])) == pytest.approx(0.6)
    assert sqrt(sum(v * v for v in axes.jerk[3:])) == pytest.approx(30.0)


@pytest.mark.parametrize("value", [0.0, -1.0, 1.71])
def test_impossible_limits_are_refused(value):
    with pytest.raises(ParameterError, match=r"it/max_translational_velocity.*1\.7"):
        read(max_translational_velocity=value)
