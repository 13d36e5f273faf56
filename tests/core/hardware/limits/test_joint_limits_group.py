"""A group limits doubles in place, copies lists, and remembers the last cycle."""

from math import inf, nan

import pytest

from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import limited_joints as codes
from station.core.hardware.limits.joint_limits_group import JointLimitsGroup
from station.core.hardware.limits.limited_joints import LIMITS, VelocitySaturation
from station.memory.doubles import doubles

MEMORY = {"previous": 0.0, "velocity_before": nan, "acceleration_before": 0.0}


def make_group(make_storage):
    """Return a group of three joints whose commands change by at most 0.1, and them."""
    state = make_storage([0.0] * 3)
    commands = make_storage([1.0, 0.05, -1.0])
    handles = [
        JointHandle(JointStateHandle(name, state, state, state, i), commands, i)
        for i, name in enumerate("abc")
    ]
    limits = dict.fromkeys(LIMITS, nan) | {
        "max_velocity": inf,
        "max_acceleration": 100.0,
    }
    group = JointLimitsGroup(VelocitySaturation, handles, [limits] * 3, [MEMORY] * 3)
    return group, commands


@pytest.mark.parametrize("make_storage", [list, doubles])
def test_commands_of_a_list_and_of_doubles_are_limited_alike(make_storage):
    group, commands = make_group(make_storage)

    assert group.enforce(0.001, 0, 3) == 0b101
    assert [*commands] == [0.1, 0.05, -0.1]
    assert group.clamp(2) == (-1.0, -0.1, codes.ACCELERATION)


@pytest.mark.parametrize("make_storage", [list, doubles])
def test_other_joints_than_those_asked_for_are_left_alone(make_storage):
    group, commands = make_group(make_storage)

    assert group.enforce(0.001, 2, 3) == 0b1
    assert [*commands] == [1.0, 0.05, -0.1]


def test_memory_can_be_read_and_replaced():
    group, commands = make_group(doubles)
    group.enforce(0.001, 0, 3)

    assert [group.memory(i)["previous"] for i in range(3)] == [0.1, 0.05, -0.1]
    group.remember(0, MEMORY | {"previous": 0.7})
    commands[0] = 5.0
    group.enforce(0.001, 0, 1)
    assert commands[0] == pytest.approx(0.8)
