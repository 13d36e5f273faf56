"""An effort command may only brake where a limit is passed, and is told why."""

import pytest

from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import (
    ClampReason,
    EffortJointSaturationHandle,
    EffortJointSoftLimitsHandle,
    JointLimits,
    SoftJointLimits,
)

LIMITS = JointLimits(-1.0, 1.0, max_velocity=2.0, max_effort=50.0)
SOFT_LIMITS = SoftJointLimits(-0.5, 0.5, k_position=10.0, k_velocity=5.0)


def make_joint(position, velocity):
    state = JointStateHandle("elbow", [position], [velocity], [0.0])
    return JointHandle(state, [0.0])


def enforce(handle, joint, command):
    joint.set_command(command)
    handle.enforce_limits(0.001)
    return joint.get_command(), handle.last_clamp.reason if handle.last_clamp else None


@pytest.mark.parametrize(
    ("position", "velocity", "asked", "expected"),
    [
        (0.0, 0.0, 20.0, (20.0, None)),
        (0.0, 0.0, 90.0, (50.0, ClampReason.EFFORT)),
        (1.5, 0.0, 20.0, (0.0, ClampReason.POSITION)),
        (-1.5, 0.0, -20.0, (0.0, ClampReason.POSITION)),
        (1.5, 0.0, -20.0, (-20.0, None)),
        (0.0, 2.5, 20.0, (0.0, ClampReason.VELOCITY)),
        (0.0, -2.5, -20.0, (0.0, ClampReason.VELOCITY)),
    ],
)
def test_saturation_lets_effort_only_point_back(position, velocity, asked, expected):
    joint = make_joint(position, velocity)
    assert enforce(EffortJointSaturationHandle(joint, LIMITS), joint, asked) == expected


@pytest.mark.parametrize(
    ("position", "velocity", "asked", "expected"),
    [
        (0.0, 0.0, 5.0, (5.0, None)),
        (0.0, -20.0, 90.0, (50.0, ClampReason.EFFORT)),
        (0.0, 2.0, 20.0, (0.0, ClampReason.VELOCITY)),
        (0.0, 3.0, 90.0, (-5.0, ClampReason.VELOCITY)),
        (0.0, 20.0, 90.0, (-50.0, ClampReason.VELOCITY)),
        (0.0, 3.0, 20.0, (-5.0, ClampReason.VELOCITY)),
        (0.5, 0.0, 20.0, (0.0, ClampReason.SOFT_POSITION)),
        (0.5, 1.0, 20.0, (-5.0, ClampReason.SOFT_POSITION)),
        (-0.5, -1.0, -20.0, (5.0, ClampReason.SOFT_POSITION)),
    ],
)
def test_soft_limits_brake_in_proportion_to_the_excess_velocity(
    position, velocity, asked, expected
):
    joint = make_joint(position, velocity)
    handle = EffortJointSoftLimitsHandle(joint, LIMITS, SOFT_LIMITS)
    assert enforce(handle, joint, asked) == expected


def test_continuous_joint_has_no_range():
    joint = make_joint(9.0, 0.0)
    limits = JointLimits(max_velocity=2.0, max_effort=50.0, angle_wraparound=True)
    handle = EffortJointSoftLimitsHandle(joint, limits, SOFT_LIMITS)
    assert enforce(handle, joint, 8.0) == (8.0, None)
