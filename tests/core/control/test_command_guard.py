"""Commands are watched wherever a handle keeps them."""

import math

import pytest

from station.core.control.command_guard import find_guards
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import InterfaceResources, RobotHW

EFFORT = "hardware_interface::EffortJointInterface"
STATE = "hardware_interface::JointStateInterface"


def one_joint(interface, command, position=0.0, velocity=0.0):
    robot = RobotHW()
    state = JointStateHandle("j", [position], [velocity], [0.0])
    states = JointStateInterface()
    states.register_handle(state)
    interface.register_handle(JointHandle(state, command))
    robot.register_interface(states)
    robot.register_interface(interface)
    return robot


def guard_of(interface, command, position=0.0, velocity=0.0):
    robot = one_joint(interface, command, position, velocity)
    claims = (InterfaceResources(interface.type_name, ("j",)),)
    (guard,) = find_guards(robot, claims)
    return guard


def test_resources_that_take_no_commands_are_not_guarded():
    robot = one_joint(EffortJointInterface(), [0.0])

    assert find_guards(robot, (InterfaceResources(STATE, ("j",)),)) == []


def test_claims_of_an_interface_the_robot_does_not_have_are_not_guarded():
    assert find_guards(RobotHW(), (InterfaceResources(EFFORT, ("j",)),)) == []


def test_rest_is_what_the_interface_says():
    command = [1.5]

    guard_of(PositionJointInterface(), command, position=0.25).write_rest()

    assert command == [0.25]


def test_an_unknown_rest_keeps_a_good_command():
    command = [1.5]

    guard_of(PositionJointInterface(), command, position=math.nan).write_rest()

    assert command == [1.5]


def test_an_unknown_rest_and_a_bad_command_give_the_last_good_one():
    command = [1.5]
    guard = guard_of(PositionJointInterface(), command, position=math.nan)
    assert not guard.remember()
    command[0] = math.nan

    guard.write_rest()

    assert command == [1.5]


def test_a_jump_is_measured_from_the_nearer_of_rest_and_last():
    command = [10.0]
    guard = guard_of(EffortJointInterface(), command)
    guard.remember()

    command[0] = 9.0
    assert guard.jump() == 1.0
    command[0] = 2.0
    assert guard.jump() == 2.0


@pytest.mark.parametrize(
    ("command", "jump"),
    [(0.0, 0.0), (0.3, 0.0), (0.5, 0.0), (0.75, 0.25), (-0.25, 0.25)],
)
def test_slowing_a_moving_joint_down_is_no_jump(command, jump):
    commands = [100.0]
    guard = guard_of(VelocityJointInterface(), commands, velocity=0.5)
    guard.remember()
    commands[0] = command

    assert guard.jump() == jump


def test_an_unknown_velocity_leaves_the_step_from_rest():
    commands = [100.0]
    guard = guard_of(VelocityJointInterface(), commands, velocity=math.nan)
    guard.remember()
    commands[0] = 0.5

    assert guard.jump() == 0.5


def test_an_excessive_step_comes_with_its_limit():
    command = [0.0]
    guard = guard_of(EffortJointInterface(), command)
    guard.remember()
    command[0] = 7.0

    assert guard.excess() == (7.0, 5.0)
