"""Many joints in one call give what one call per joint gives."""

import pytest

from station.core.errors import InvalidCommandError
from station.core.hardware.interfaces import (
    JointGroup,
    JointHandle,
    JointStateGroup,
    JointStateHandle,
)
from station.memory.doubles import doubles


def handles(indices, command_indices=None):
    position, velocity = [0.1, 0.2, 0.3, 0.4], [1.0, 2.0, 3.0, 4.0]
    effort, command = [5.0, 6.0, 7.0, 8.0], [0.0] * 4
    return [
        JointHandle(
            JointStateHandle(f"j{index}", position, velocity, effort, index),
            command,
            command_indices[number] if command_indices else None,
        )
        for number, index in enumerate(indices)
    ]


ORDERS = [[0, 1, 2, 3], [1, 2], [2, 1], [0, 3], [3], []]


@pytest.mark.parametrize("indices", ORDERS)
def test_a_group_reads_like_its_handles(indices):
    joints = handles(indices)

    group = JointStateGroup(joints)

    assert group.names == [joint.name for joint in joints]
    assert group.get_positions() == [joint.get_position() for joint in joints]
    assert group.get_velocities() == [joint.get_velocity() for joint in joints]
    assert group.get_efforts() == [joint.get_effort() for joint in joints]


@pytest.mark.parametrize("indices", ORDERS)
def test_a_group_commands_like_its_handles(indices):
    joints = handles(indices)
    values = [10.0 + number for number in range(len(indices))]

    group = JointGroup(joints)
    group.set_commands(values)

    assert group.get_commands() == values
    assert [joint.get_command() for joint in joints] == values


def test_joints_of_different_robots_make_a_group():
    joints = [*handles([0, 1]), *handles([0])]
    group = JointGroup(joints)

    group.set_commands([1.0, 2.0, 3.0])

    assert [joint.get_command() for joint in joints] == [1.0, 2.0, 3.0]


def test_commands_may_be_in_other_slots_than_states():
    joints = handles([0, 1], [3, 2])

    JointGroup(joints).set_commands([1.0, 2.0])

    assert [joint.get_command() for joint in joints] == [1.0, 2.0]


def test_what_is_read_is_a_copy():
    group = JointStateGroup(handles([0, 1]))

    group.get_positions()[0] = 99.0

    assert group.get_positions()[0] == 0.1


@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_wrong_number_of_commands_is_refused_and_changes_nothing(count):
    group = JointGroup(handles([0, 1]))

    with pytest.raises(ValueError, match=f"{count} commands for 2 joints"):
        group.set_commands([1.0] * count)

    assert group.get_commands() == [0.0, 0.0]


def of_memory(memory, indices):
    parts = memory[:4], memory[4:8], memory[8:]
    return [JointStateHandle(f"j{index}", *parts, index) for index in indices]


@pytest.mark.parametrize(
    ("indices", "blocks"), [([0, 1, 2, 3], 1), ([0, 1, 2], 3), ([0, 1, 3], 4)]
)
def test_states_in_memory_are_read_in_place_in_few_pieces(indices, blocks):
    memory = doubles(range(12))
    group = JointStateGroup(of_memory(memory, indices))

    assert len(group.blocks) == blocks
    assert group.refresh is None
    memory[4] = 40.0
    states = [value for block in group.blocks for value in block]
    expected = [*(first + i for first in (0, 4, 8) for i in indices)]
    expected[len(indices)] = 40.0
    assert states == expected


def test_states_in_lists_are_copied_when_asked():
    joints = [*handles([0, 1]), *of_memory(doubles(range(12)), [3])]
    group = JointStateGroup(joints)
    joints[0].position_storage[0] = 7.0

    group.refresh()

    found = [block.tolist() for block in group.blocks]
    assert found == [[7.0, 0.2, 3.0], [1.0, 2.0, 7.0], [5.0, 6.0, 11.0]]


@pytest.mark.parametrize("wrong", ["0.5", [0.5], None])
def test_a_command_that_is_no_number_is_refused_by_the_name_of_its_joint(wrong):
    state, commands = doubles([0.0, 0.0]), doubles([1.0, 2.0])
    joints = [
        JointHandle(JointStateHandle(name, state, state, state, index), commands)
        for index, name in enumerate(("shoulder", "elbow"))
    ]
    with pytest.raises(InvalidCommandError, match=r"'elbow' is .* must be a number"):
        JointGroup(joints).set_commands([0.5, wrong])
    assert list(commands) == [1.0, 2.0]
