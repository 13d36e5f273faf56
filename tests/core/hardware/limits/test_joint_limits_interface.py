"""An interface enforces and resets all its handles, and sums up their clamps."""

import gzip
import json
from pathlib import Path

import pytest

from station.core.errors import ResourceNotFoundError
from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import (
    EffortJointSaturationHandle,
    EffortJointSaturationInterface,
    JointLimits,
    JointLimitsHandle,
    JointLimitsInterface,
    VelocityJointSaturationHandle,
    VelocityJointSaturationInterface,
)
from station.core.hardware.limits.limited_joints import MOST_JOINTS
from station.memory.doubles import doubles

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "joint_limits.json.gz"


@pytest.fixture(scope="module")
def cases():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)["interface_cases"]


def make_handle(name, command, max_effort):
    joint = JointHandle(JointStateHandle(name, [0.0], [0.0], [0.0]), command)
    limits = JointLimits(max_velocity=1.0, max_effort=max_effort)
    return EffortJointSaturationHandle(joint, limits)


def test_names_are_sorted_as_recorded(cases):
    interface = EffortJointSaturationInterface()
    interface.register_handle(make_handle("b", [0.0], 2.0))
    interface.register_handle(make_handle("a", [0.0], 2.0))
    assert interface.get_names() == cases[0]["result"]


def test_unknown_joint_is_refused_with_the_recorded_message(cases):
    with pytest.raises(ResourceNotFoundError) as caught:
        EffortJointSaturationInterface().get_handle("zzz")
    assert caught.value.message == cases[1]["what"]


def test_handle_registered_again_replaces_the_first_as_recorded(cases):
    command_a, command_b = [100.0], [100.0]
    interface = EffortJointSaturationInterface()
    interface.register_handle(make_handle("a", command_a, 2.0))
    interface.register_handle(make_handle("b", command_b, 2.0))
    interface.register_handle(make_handle("a", command_a, 5.0))
    interface.enforce_limits(0.001)
    assert interface.get_names() == cases[2]["names"]
    assert command_a == [cases[2]["cmd_a"]]
    assert command_b == [cases[2]["cmd_b"]]


def test_clamps_of_all_joints_are_summed_and_listed():
    interface = EffortJointSaturationInterface()
    for name, command in (("a", 1.0), ("b", 9.0), ("c", -9.0)):
        interface.register_handle(make_handle(name, [command], 2.0))
    interface.enforce_limits(0.001)
    assert interface.clamp_count == 2
    assert [(c.joint, c.given) for c in interface.last_clamps()] == [
        ("b", 2.0),
        ("c", -2.0),
    ]


def test_reset_reaches_every_handle():
    interface = VelocityJointSaturationInterface()
    commands = [[1.0], [1.0]]
    for name, command in zip("ab", commands, strict=True):
        joint = JointHandle(JointStateHandle(name, [0.0], [0.0], [0.0]), command)
        limits = JointLimits(max_velocity=1.0, max_acceleration=2.0)
        interface.register_handle(VelocityJointSaturationHandle(joint, limits))
    for _ in range(2):
        interface.enforce_limits(0.25)
        interface.reset()
        commands[0][0] = commands[1][0] = 1.0
    interface.enforce_limits(0.25)
    assert commands == [[0.5], [0.5]]


def make_velocity_handles(storage, names="abc"):
    """Return handles that let commands change by 0.1 in 1 ms, on one storage."""
    state = storage([0.0] * len(names))
    commands = storage([1.0] * len(names))
    limits = JointLimits(max_velocity=9.0, max_acceleration=100.0)
    handles = [
        VelocityJointSaturationHandle(
            JointHandle(JointStateHandle(name, state, state, state, i), commands, i),
            limits,
        )
        for i, name in enumerate(names)
    ]
    return handles, commands


def register(handles):
    interface = VelocityJointSaturationInterface()
    for handle in handles:
        interface.register_handle(handle)
    return interface


def test_handle_and_interface_share_what_they_remember():
    handles, commands = make_velocity_handles(doubles)
    handles[0].enforce_limits(0.001)  # alone, before it is registered
    interface = register(handles)
    commands[0] = 1.0
    interface.enforce_limits(0.001)
    commands[0] = 1.0
    handles[0].enforce_limits(0.001)

    assert [*commands] == pytest.approx([0.3, 0.1, 0.1])
    handles[0].reset()
    commands[0] = 1.0
    interface.enforce_limits(0.001)
    assert commands[0] == pytest.approx(0.1)
    assert handles[0].clamp_count == 4


@pytest.mark.parametrize("storage", [list, doubles])
def test_only_active_joints_are_limited(storage):
    handles, commands = make_velocity_handles(storage, "abcd")
    interface = register(handles)

    interface.activate(["a", "c", "d"])
    interface.enforce_limits(0.001)

    assert [*commands] == [0.1, 1.0, 0.1, 0.1]
    assert [handle.clamp_count for handle in handles] == [1, 0, 1, 1]


def test_handle_in_two_interfaces_is_enforced_by_both():
    handles, commands = make_velocity_handles(doubles)
    first, second = register(handles[:2]), register(handles)
    first.register_handle(handles[1])

    second.enforce_limits(0.001)
    assert [*commands] == [0.1, 0.1, 0.1]
    commands[0] = commands[1] = 1.0
    first.enforce_limits(0.001)
    assert [*commands] == [0.2, 0.2, 0.1]


def test_handles_of_several_kinds_are_enforced_together():
    handles, commands = make_velocity_handles(doubles)
    interface = JointLimitsInterface()
    for handle in handles:
        interface.register_handle(handle)
    effort = [100.0]
    interface.register_handle(make_handle("z", effort, 2.0))
    far = make_velocity_handles(doubles, "xy")[0]
    interface.register_handle(far[1])

    interface.enforce_limits(0.001)

    assert [*commands, *effort] == [0.1, 0.1, 0.1, 2.0]
    assert far[1].joint.get_command() == 0.1


def test_more_joints_than_a_mask_has_bits_are_limited():
    names = [f"j{i:03}" for i in range(MOST_JOINTS + 3)]
    handles, commands = make_velocity_handles(doubles, names)
    interface = register(handles)

    interface.enforce_limits(0.001)

    assert [*commands] == [0.1] * len(names)
    assert interface.clamp_count == len(names)


def test_handle_with_a_way_of_its_own_is_asked():
    class Halving(JointLimitsHandle):
        def enforce_limits(self, period):
            self.joint.set_command(self.joint.get_command() / 2.0)

    commands = doubles([1.0])
    joint = JointHandle(JointStateHandle("a", [0.0], [0.0], [0.0]), commands)
    interface = JointLimitsInterface()
    interface.register_handle(Halving(joint, JointLimits()))
    interface.enforce_limits(0.001)
    assert commands[0] == 0.5
