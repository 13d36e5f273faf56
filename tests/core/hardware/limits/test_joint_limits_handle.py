"""All six handles answer as the recorded original does, and count what they cut.

A group limits doubles in place, copies lists, and remembers the last cycle.
"""

import gzip
import json
from math import copysign, inf, nan
from pathlib import Path

import pytest

from station.core.hardware import limits as joint_limits
from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import (
    Clamp,
    ClampReason,
    JointLimits,
    JointLimitsError,
    PositionJointSaturationHandle,
    SoftJointLimits,
    limited_joints as codes,
)
from station.core.hardware.limits.joint_limits_handle import JointLimitsGroup
from station.core.hardware.limits.limited_joints import LIMITS, VelocitySaturation
from station.memory.doubles import doubles

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "joint_limits.json.gz"
QUANTITIES = ("velocity", "acceleration", "jerk", "effort")
CLASSES = [
    f"{command}Joint{kind}"
    for command in ("Position", "Velocity", "Effort")
    for kind in ("Saturation", "SoftLimits")
]


@pytest.fixture(scope="module")
def sequences():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)["sequences"]


def read_limits(recorded):
    found = {"angle_wraparound": recorded["angle_wraparound"]}
    if recorded["has_position_limits"]:
        found["min_position"] = recorded["min_position"]
        found["max_position"] = recorded["max_position"]
    for quantity in QUANTITIES:
        if recorded[f"has_{quantity}_limits"]:
            found[f"max_{quantity}"] = recorded[f"max_{quantity}"]
    return JointLimits(**found)


def make_handle(sequence, joint):
    arguments = [joint, read_limits(sequence["limits"])]
    if "soft_limits" in sequence:
        arguments.append(SoftJointLimits(**sequence["soft_limits"]))
    handle = getattr(joint_limits, sequence["class"] + "Handle")(*arguments)
    if sequence["via"] == "handle":
        return handle
    interface = getattr(joint_limits, sequence["class"] + "Interface")()
    interface.register_handle(handle)
    return interface


def play(sequence, enforcer, slots):
    """Return the commands after each step, with their signs."""
    given = []
    for step in sequence["steps"]:
        if step["op"] == "reset":
            enforcer.reset()
            continue
        for slot, key in zip(slots, ("pos", "vel", "eff", "cmd_in"), strict=True):
            slot[0] = float(step[key])
        enforcer.enforce_limits(step["period"])
        given.append((slots[3][0], copysign(1.0, slots[3][0])))
    return given


@pytest.mark.parametrize("name", CLASSES)
def test_commands_equal_the_recorded_ones_bit_by_bit(name, sequences):
    played = 0
    for sequence in sequences:
        if sequence["class"] != name or sequence["exception"]:
            continue
        slots = [[0.0], [0.0], [0.0], [0.0]]
        joint = JointHandle(JointStateHandle("j1", *slots[:3]), slots[3])
        commands = [s["cmd_out"] for s in sequence["steps"] if s["op"] == "enforce"]
        expected = [(float(c), copysign(1.0, float(c))) for c in commands]
        assert play(sequence, make_handle(sequence, joint), slots) == expected
        played += len(expected)
    assert played > 500


@pytest.mark.parametrize("name", CLASSES)
def test_missing_limits_are_refused_as_recorded(name, sequences):
    for sequence in sequences:
        if sequence["class"] != name or not sequence["exception"]:
            continue
        joint = JointHandle(JointStateHandle("j1", [0.0], [0.0], [0.0]), [0.0])
        with pytest.raises(JointLimitsError) as caught:
            make_handle(sequence, joint)
        # one of the original's messages says "efforts"
        recorded = sequence["exception"]["what"].replace("efforts", "effort")
        assert caught.value.message == recorded
        assert "'j1'" in caught.value.remedy


def make_saturation_handle():
    command = [0.0]
    joint = JointHandle(JointStateHandle("elbow", [0.0], [0.0], [0.0]), command)
    limits = JointLimits(min_position=-1.0, max_position=1.0)
    return PositionJointSaturationHandle(joint, limits), command


def test_command_inside_the_limits_is_not_counted():
    handle, command = make_saturation_handle()
    command[0] = 1.0
    handle.enforce_limits(0.001)
    assert (handle.clamp_count, handle.last_clamp) == (0, None)


def test_clamps_are_counted_and_the_last_one_is_kept():
    handle, command = make_saturation_handle()
    for asked in (5.0, -3.0):
        command[0] = asked
        handle.enforce_limits(0.001)
    assert handle.clamp_count == 2
    assert handle.last_clamp == Clamp("elbow", -3.0, -1.0, ClampReason.POSITION)


def test_reset_keeps_the_clamp_figures():
    handle, command = make_saturation_handle()
    command[0] = 5.0
    handle.enforce_limits(0.001)
    handle.reset()
    assert handle.clamp_count == 1
    assert handle.last_clamp is not None


def test_nan_command_passes_through_and_is_not_counted():
    handle, command = make_saturation_handle()
    command[0] = nan
    handle.enforce_limits(0.001)
    assert command[0] != command[0]  # only NaN differs from itself
    assert handle.clamp_count == 0
    command[0] = 0.5
    handle.enforce_limits(0.001)
    assert command[0] == 0.5


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
