"""Commands reach the arm, or its motion ends with the reason."""

from math import nan

import pytest

from station.core.franka import RobotMode
from station.core.hardware.limits import LimitMode
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.commands.cartesian_commands import CartesianCommands
from station.hw.franka.commands.command_filter import CommandFilter
from station.hw.franka.commands.command_sender import CommandSender
from station.hw.franka.commands.command_settings import CommandSettings
from station.hw.franka.commands.joint_commands import JointCommands
from station.memory.doubles import put
from tests.hw.franka.scripted_arm import ScriptedArm
from tests.hw.franka.test_franka_hw import JOINTS

SETTINGS = CommandSettings(
    rate_limiting=False,
    cutoff_frequency=1000.0,
    internal_controller=ControllerMode.JOINT_IMPEDANCE,
)


@pytest.fixture
def arm() -> ScriptedArm:
    return ScriptedArm()


@pytest.fixture
def commands(arm) -> JointCommands:
    return JointCommands(arm.state, JOINTS, LimitMode.ROS_CONTROL)


@pytest.fixture
def sender(arm, commands) -> CommandSender:
    cartesian = CartesianCommands(arm, "panda", PANDA_LIMITS)
    sender = CommandSender(
        arm, commands, cartesian, CommandFilter(PANDA_LIMITS, arm.state, commands)
    )
    sender.begin(ControlMode.JOINT_VELOCITY, SETTINGS)
    arm.start_motion(ControllerMode.JOINT_IMPEDANCE, MotionGeneratorMode.JOINT_VELOCITY)
    return sender


def test_command_is_sent_once_per_cycle(arm, commands, sender):
    put(commands.velocities, [0.001] * 7)
    sender.send_limited(0.001)

    assert arm.sent == [[0.001] * 7]


def test_command_that_is_not_finite_ends_the_motion_unsent(arm, commands, sender):
    commands.velocities[3] = nan
    sender.send_limited(0.001)

    assert arm.sent == []
    assert arm.state.robot_mode is RobotMode.IDLE
    assert sender.refusal == "a command is not finite"
    sender.send_limited(0.001)
    assert arm.sent == []
