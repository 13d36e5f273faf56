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
    VelocityJointSaturationHandle,
    VelocityJointSaturationInterface,
)

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
