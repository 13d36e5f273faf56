"""Saturation and soft limits give the same bits interpreted and compiled."""

from math import nan

import pytest
from hypothesis import given, settings

from station.core.hardware.limits import limited_joints
from station.core.hardware.limits.joint_limits_handle import ClampReason
from station.memory.doubles import doubles
from tests.both_modes import both
from tests.core.hardware.limits.joints_of_limits import joints, play

KINDS = [
    "PositionLimits",
    "VelocitySaturation",
    "VelocitySoftLimits",
    "EffortSaturation",
    "EffortSoftLimits",
]


@pytest.mark.parametrize("kind", KINDS)
def test_both_modes_agree_to_the_bit(kind):
    interpreted, compiled = (getattr(module, kind) for module in both("limited_joints"))

    @settings(derandomize=True)
    @given(joints())
    def compare(case):
        assert play(interpreted, case) == play(compiled, case)

    compare()


def efforts(commands):
    """Return a group of joints with an effort limit of 10, and its views."""
    count = len(commands)
    names = (
        *limited_joints.LIMITS,
        *limited_joints.MEMORY,
        "position",
        "velocity",
        "asked",
        "reason",
    )
    views = {name: doubles([0.0] * count) for name in names}
    views["min_position"] = views["max_position"] = doubles([nan] * count)
    views["max_velocity"] = doubles([1.0] * count)
    views["max_effort"] = doubles([10.0] * count)
    views["command"] = doubles(commands)
    return limited_joints.EffortSaturation(views), views


def test_mask_names_the_joints_whose_command_was_changed():
    group, views = efforts([1.0, -20.0, 3.0, 30.0])

    assert group.enforce(0.001, 0, 4) == 0b1010
    assert views["command"].tolist() == [1.0, -10.0, 3.0, 10.0]
    assert [views["asked"][1], views["asked"][3]] == [-20.0, 30.0]
    assert views["reason"].tolist()[1::2] == [limited_joints.EFFORT] * 2


def test_only_the_joints_of_the_range_are_limited():
    group, views = efforts([20.0, 20.0, 20.0])

    assert group.enforce(0.001, 1, 2) == 0b1
    assert views["command"].tolist() == [20.0, 10.0, 20.0]


def test_mask_has_a_bit_for_each_of_the_most_joints():
    group, _ = efforts([20.0] * limited_joints.MOST_JOINTS)

    assert (
        group.enforce(0.001, 0, limited_joints.MOST_JOINTS)
        == 2**limited_joints.MOST_JOINTS - 1
    )


def test_codes_are_in_the_order_of_the_reasons():
    for code, reason in enumerate(ClampReason):
        assert getattr(limited_joints, reason.name) == code
