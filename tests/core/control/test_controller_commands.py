"""The commands of one controller: checked, compared, put back, rested."""

import math

import numpy as np
import pytest

from station.core.control.command_guard import find_guards
from station.core.control.controller_commands import ControllerCommands
from station.core.hardware.interfaces import EffortJointInterface
from station.core.hardware.robot_hw import InterfaceResources
from station.testing.scripted import ScriptedBench


@pytest.fixture
def storage():
    """The effort commands of the robot."""
    return []


@pytest.fixture
def commands(storage):
    """The commands of a controller that has claimed j1 and j3."""
    robot = ScriptedBench().robot
    claim = InterfaceResources(EffortJointInterface.type_name, ("j1", "j3"))
    guards = find_guards(robot, (claim,))
    storage.append(robot.joints.effort_command)
    return ControllerCommands(guards)


def test_finite_floats_are_not_refused(commands):
    assert commands.refused() is None


def test_an_overflowing_sum_of_finite_floats_is_not_refused(commands, storage):
    storage[0][:] = [1.5e308, 0.0, 1.5e308]

    assert commands.refused() is None


@pytest.mark.parametrize("value", [math.nan, 0j, "1", None, 10**400])
def test_a_refused_command_is_named(commands, storage, value):
    storage[0][2] = value

    assert commands.refused().endswith("for 'j3'")


def test_what_is_not_claimed_is_not_looked_at(commands, storage):
    storage[0][1] = math.nan

    assert commands.refused() is None


def test_what_others_write_afterwards_is_noticed_and_undone(commands, storage):
    storage[0][:] = [1.0, 0.0, 3.0]
    commands.refused()
    storage[0][2] = 9.0

    assert not commands.is_as_written()
    commands.write_again()

    assert commands.is_as_written()
    assert storage[0] == [1.0, 0.0, 3.0]


def test_an_array_in_place_of_a_command_is_noticed(commands, storage):
    commands.refused()
    storage[0][0] = np.zeros(2)

    assert not commands.is_as_written()


def test_shared_commands_may_be_written_by_several(commands, storage):
    commands.refused()
    commands.is_shared = True
    storage[0][0] = 2.0

    assert commands.is_as_written()


@pytest.mark.parametrize("value", [5.0, math.nan, 0j, False, np.zeros(2)])
def test_what_a_call_has_written_is_put_back_and_named(commands, storage, value):
    before = commands.values()
    storage[0][2] = value

    assert commands.put_back(before).endswith("for 'j3'")

    assert storage[0] == [0.0, 0.0, 0.0]
    assert type(storage[0][2]) is float


def test_a_call_that_wrote_nothing_is_not_blamed(commands, storage):
    storage[0][0] = math.nan

    assert commands.put_back(commands.values()) is None
