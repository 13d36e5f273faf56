"""Saturation and soft limits give the same bits interpreted and compiled."""

from math import nan

import pytest
from hypothesis import given, settings

from station.core.hardware.limits import clamp_codes
from station.core.hardware.limits import limited_joints as kernel
from station.memory.doubles import doubles
from tests.both_modes import both
from tests.core.hardware.limits.joints_of_limits import joints, play

KINDS = [
    f"{quantity}{kind}"
    for quantity in ("Position", "Velocity", "Effort")
    for kind in ("Saturation", "SoftLimits")
]


@pytest.mark.parametrize("kind", KINDS)
def test_both_modes_agree_to_the_bit(kind):
    name = "position_limits" if kind.startswith("Position") else "limited_joints"
    interpreted, compiled = (getattr(module, kind) for module in both(name))

    @settings(derandomize=True)
    @given(joints())
    def compare(case):
        assert play(interpreted, case) == play(compiled, case)

    compare()


def efforts(commands):
    """Return a group of joints with an effort limit of 10, and its views."""
    count = len(commands)
    names = (*kernel.LIMITS, *kernel.MEMORY, "position", "velocity", "asked", "reason")
    views = {name: doubles([0.0] * count) for name in names}
    views["min_position"] = views["max_position"] = doubles([nan] * count)
    views["max_velocity"] = doubles([1.0] * count)
    views["max_effort"] = doubles([10.0] * count)
    views["command"] = doubles(commands)
    return kernel.EffortSaturation(views), views


def test_mask_names_the_joints_whose_command_was_changed():
    group, views = efforts([1.0, -20.0, 3.0, 30.0])

    assert group.enforce(0.001, 0, 4) == 0b1010
    assert views["command"].tolist() == [1.0, -10.0, 3.0, 10.0]
    assert [views["asked"][1], views["asked"][3]] == [-20.0, 30.0]
    assert views["reason"].tolist()[1::2] == [clamp_codes.EFFORT] * 2


def test_only_the_joints_of_the_range_are_limited():
    group, views = efforts([20.0, 20.0, 20.0])

    assert group.enforce(0.001, 1, 2) == 0b1
    assert views["command"].tolist() == [20.0, 10.0, 20.0]


def test_mask_has_a_bit_for_each_of_the_most_joints():
    group, _ = efforts([20.0] * kernel.MOST_JOINTS)

    assert group.enforce(0.001, 0, kernel.MOST_JOINTS) == 2**kernel.MOST_JOINTS - 1
