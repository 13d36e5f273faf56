"""Values of joints are shared where they are doubles, and copied where they are not."""

import pytest

from station.controllers.set_point_controller import ControlledJoints
from station.core.hardware.interfaces import (
    JointGroup,
    JointHandle,
    JointStateGroup,
    JointStateHandle,
)
from station.memory.doubles import doubles, zeros


def make_group(make):
    position, velocity, effort, command = (make([v, v + 0.5]) for v in range(4))
    states = [
        JointStateHandle(name, position, velocity, effort, index)
        for index, name in enumerate("ab")
    ]
    handles = [JointHandle(state, command) for state in states]
    return JointGroup(handles), position, command


def test_doubles_side_by_side_are_the_robots_own():
    group, position, command = make_group(doubles)
    memory = ControlledJoints(group)
    assert not memory.is_copy
    position[1] = 7.0
    assert memory.positions.tolist() == [0.0, 7.0]
    memory.commands[0] = 8.0
    assert command[0] == 8.0


@pytest.mark.parametrize("make", [list, doubles])
def test_reading_and_writing_pass_the_values_on(make):
    group, position, command = make_group(make)
    memory = ControlledJoints(group)
    position[1] = 7.0
    memory.read()
    assert memory.positions.tolist() == [0.0, 7.0]
    assert memory.velocities.tolist() == [1.0, 1.5]
    assert memory.efforts.tolist() == [2.0, 2.5]
    memory.commands[0] = 8.0
    memory.commands[1] = 9.0
    memory.write()
    assert list(command) == [8.0, 9.0]


def test_without_commands_nothing_is_commanded():
    group = JointStateGroup([JointStateHandle("a", zeros(1), zeros(1), zeros(1), 0)])
    memory = ControlledJoints(group)
    assert not memory.is_copy
    memory.write()
    assert memory.commands.tolist() == [0.0]
    assert memory.size == 1
