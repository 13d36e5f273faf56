"""A velocity command keeps to velocity, acceleration and range, and is told why."""

import pytest

from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import (
    ClampReason,
    JointLimits,
    SoftJointLimits,
    VelocityJointSaturationHandle,
    VelocityJointSoftLimitsHandle,
)

SOFT_LIMITS = SoftJointLimits(-0.5, 0.5, k_position=10.0, k_velocity=1.0)


def make_joint(position=0.0, velocity=0.0):
    state = JointStateHandle("elbow", [position], [velocity], [0.0])
    return JointHandle(state, [0.0])


def enforce(handle, joint, command):
    joint.set_command(command)
    handle.enforce_limits(0.1)
    return joint.get_command(), handle.last_clamp.reason if handle.last_clamp else None


def test_saturation_ramps_at_the_acceleration_limit_up_to_the_velocity_limit():
    joint = make_joint()
    limits = JointLimits(max_velocity=1.0, max_acceleration=4.0)
    handle = VelocityJointSaturationHandle(joint, limits)
    results = [enforce(handle, joint, 9.0) for _ in range(3)]
    assert results == [
        (0.4, ClampReason.ACCELERATION),
        (0.8, ClampReason.ACCELERATION),
        (1.0, ClampReason.VELOCITY),
    ]


def test_reset_starts_the_ramp_again_from_rest():
    joint = make_joint()
    limits = JointLimits(max_velocity=1.0, max_acceleration=4.0)
    handle = VelocityJointSaturationHandle(joint, limits)
    enforce(handle, joint, 9.0)
    handle.reset()
    assert enforce(handle, joint, 9.0)[0] == 0.4


@pytest.mark.parametrize(
    ("position", "velocity", "expected"),
    [
        (0.0, 0.9, (1.0, ClampReason.VELOCITY)),
        (0.0, 0.0, (0.5, ClampReason.ACCELERATION)),
        (0.475, 0.0, (0.25, ClampReason.SOFT_POSITION)),
    ],
)
def test_soft_limits_name_the_active_limit(position, velocity, expected):
    joint = make_joint(position, velocity)
    limits = JointLimits(-1.0, 1.0, max_velocity=1.0, max_acceleration=5.0)
    handle = VelocityJointSoftLimitsHandle(joint, limits, SOFT_LIMITS)
    given, reason = enforce(handle, joint, 9.0)
    assert given == pytest.approx(expected[0], abs=1e-15)  # the order of operations
    assert reason is expected[1]
