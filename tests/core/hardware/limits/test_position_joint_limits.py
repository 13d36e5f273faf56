"""A position command is slowed down towards its bounds, and told why."""

from math import inf

import pytest

from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import (
    ClampReason,
    JointLimits,
    PositionJointSaturationHandle,
    PositionJointSoftLimitsHandle,
    SoftJointLimits,
)

LIMITS = JointLimits(min_position=-1.0, max_position=1.0, max_velocity=2.0)
SOFT_LIMITS = SoftJointLimits(-0.8, 0.8, k_position=10.0, k_velocity=1.0)


def make_joint(position):
    command = [0.0]
    return JointHandle(JointStateHandle("elbow", [position], [0.0], [0.0]), command)


def enforce(handle, joint, command):
    joint.set_command(command)
    handle.enforce_limits(0.1)
    return joint.get_command(), handle.last_clamp.reason if handle.last_clamp else None


@pytest.mark.parametrize(
    ("position", "expected"),
    [
        (0.0, (0.2, ClampReason.VELOCITY)),
        (0.9, (1.0, ClampReason.POSITION)),
        (3.0, (1.0, ClampReason.POSITION)),
    ],
)
def test_saturation_names_the_active_limit(position, expected):
    joint = make_joint(position)
    assert enforce(PositionJointSaturationHandle(joint, LIMITS), joint, inf) == expected


@pytest.mark.parametrize(
    ("position", "expected"),
    [
        (0.0, (0.2, ClampReason.VELOCITY)),
        (0.75, (0.75 + 10.0 * (0.8 - 0.75) * 0.1, ClampReason.SOFT_POSITION)),
        (1.5, (1.0, ClampReason.POSITION)),
    ],
)
def test_soft_limits_name_the_active_limit(position, expected):
    joint = make_joint(position)
    handle = PositionJointSoftLimitsHandle(joint, LIMITS, SOFT_LIMITS)
    given, reason = enforce(handle, joint, 5.0)
    assert given == pytest.approx(expected[0], abs=1e-15)  # the order of operations
    assert reason is expected[1]


def test_soft_limits_creep_to_the_soft_bound_and_never_beyond():
    joint = make_joint(0.0)
    handle = PositionJointSoftLimitsHandle(joint, LIMITS, SOFT_LIMITS)
    for _ in range(100):
        enforce(handle, joint, 5.0)
    assert joint.get_command() == pytest.approx(0.8, abs=1e-12)  # geometric approach


def test_soft_limits_of_a_continuous_joint_bound_only_the_velocity():
    joint = make_joint(7.0)
    limits = JointLimits(max_velocity=2.0, angle_wraparound=True)
    handle = PositionJointSoftLimitsHandle(joint, limits, SOFT_LIMITS)
    assert enforce(handle, joint, 9.0) == (7.2, ClampReason.VELOCITY)


def test_reset_starts_again_from_the_measured_position():
    joint = make_joint(0.5)
    handle = PositionJointSaturationHandle(joint, LIMITS)
    enforce(handle, joint, -1.0)
    handle.reset()
    assert enforce(handle, joint, -1.0)[0] == 0.3
