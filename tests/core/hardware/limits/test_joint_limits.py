"""Limits that no command could satisfy are refused, by joint and by value."""

from dataclasses import FrozenInstanceError
from math import inf, nan

import pytest

from station.core.hardware.limits import JointLimits, JointLimitsError, SoftJointLimits


def test_limits_are_absent_unless_given():
    limits = JointLimits()
    assert limits.max_velocity is None
    assert not limits.has_position_limits
    limits.validate("elbow")


def test_limits_cannot_be_changed():
    limits = JointLimits(max_effort=1.0)
    with pytest.raises(FrozenInstanceError):
        limits.max_effort = 2.0  # type: ignore[misc]  # that is the test


@pytest.mark.parametrize(
    ("limits", "part"),
    [
        (JointLimits(min_position=1.0), "only one position bound"),
        (JointLimits(max_position=1.0), "only one position bound"),
        (JointLimits(min_position=2.0, max_position=-2.0), "from 2.0 to -2.0"),
        (JointLimits(min_position=nan, max_position=1.0), "from nan to 1.0"),
        (JointLimits(max_velocity=-1.0), "velocity limit of -1.0"),
        (JointLimits(max_acceleration=nan), "acceleration limit of nan"),
        (JointLimits(max_jerk=-inf), "jerk limit of -inf"),
        (JointLimits(max_effort=-0.1), "effort limit of -0.1"),
    ],
)
def test_impossible_limits_are_refused_with_joint_and_value(limits, part):
    with pytest.raises(JointLimitsError, match="'elbow'") as caught:
        limits.validate("elbow")
    assert part in caught.value.message
    assert caught.value.remedy


@pytest.mark.parametrize(
    ("soft_limits", "part"),
    [
        (SoftJointLimits(1.0, -1.0, 1.0, 1.0), "from 1.0 to -1.0"),
        (SoftJointLimits(-1.0, nan, 1.0, 1.0), "from -1.0 to nan"),
        (SoftJointLimits(-1.0, 1.0, -2.0, 1.0), "k_position=-2.0"),
        (SoftJointLimits(-1.0, 1.0, 2.0, inf), "k_velocity=inf"),
    ],
)
def test_impossible_soft_limits_are_refused_with_joint_and_value(soft_limits, part):
    with pytest.raises(JointLimitsError, match="'elbow'") as caught:
        soft_limits.validate("elbow")
    assert part in caught.value.message


@pytest.mark.parametrize(
    "limits",
    [JointLimits(min_position=0.0, max_position=0.0), JointLimits(max_velocity=inf)],
)
def test_degenerate_limits_are_accepted(limits):
    limits.validate("elbow")
