"""Command buffers, their seeds and their limits."""

from math import nan

import pytest

from station.core.description.urdf import (
    Joint,
    JointLimit,
    JointType,
    Pose,
    SafetyController,
)
from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.commands.joint_commands import JointCommands
from station.hw.franka.commands.rate_limiter import rate_limits_of

NAMES = [f"a_joint{number}" for number in range(1, 8)]


def joint(name: str, *, with_safety: bool = True) -> Joint:
    return Joint(
        name=name,
        type=JointType.REVOLUTE,
        parent="p",
        child="c",
        origin=Pose(),
        axis=(0.0, 0.0, 1.0),
        limit=JointLimit(-1.0, 1.0, 2.0, 10.0),
        damping=0.0,
        friction=0.0,
        mimic=None,
        safety=SafetyController(-1.0, 1.0, 100.0, 40.0) if with_safety else None,
    )


@pytest.fixture
def commands() -> JointCommands:
    commands = JointCommands(RobotState(), NAMES)
    commands.add_limits([joint(name) for name in NAMES], rate_limits_of(PANDA_LIMITS))
    return commands


def test_first_commands_keep_the_arm_at_its_pose() -> None:
    state = RobotState()
    commands = JointCommands(state, NAMES)
    commands.efforts[2] = commands.velocities[2] = 3.0
    state.q_d = [0.1] * 7
    commands.begin_commands(ControlMode.NONE)
    assert list(commands.positions) == [0.1] * 7
    assert list(commands.efforts) == list(commands.velocities) == [0.0] * 7


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        (ControlMode.JOINT_POSITION, (0.002, 9.0, 99.0)),
        (ControlMode.JOINT_VELOCITY, (9.0, 0.014999, 99.0)),
        (ControlMode.JOINT_TORQUE, (9.0, 9.0, 10.0)),
        (ControlMode.JOINT_TORQUE | ControlMode.JOINT_POSITION, (0.002, 9.0, 10.0)),
    ],
)
def test_limits_of_the_commanded_kinds_alone_are_enforced(
    commands: JointCommands, mode: ControlMode, expected: tuple[float, float, float]
) -> None:
    commands.begin_commands(mode)
    commands.positions[0] = commands.velocities[0] = 9.0
    commands.efforts[0] = 99.0
    for limits in commands.limits():
        limits.enforce_limits(0.001)
    given = commands.positions[0], commands.velocities[0], commands.efforts[0]
    assert given == pytest.approx(expected)


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        (ControlMode.JOINT_TORQUE, False),
        (ControlMode.JOINT_TORQUE | ControlMode.JOINT_VELOCITY, False),
        (ControlMode.JOINT_VELOCITY, True),
        (ControlMode.NONE, True),
    ],
)
def test_only_commanded_kinds_must_be_finite(
    commands: JointCommands, mode: ControlMode, *, expected: bool
) -> None:
    commands.begin_commands(mode)
    commands.efforts[6] = nan
    found = [check.first_bad() for check in commands.checks()]
    assert all(index < 0 for index in found) is expected


def test_range_of_goals_is_that_of_the_description(commands: JointCommands) -> None:
    assert commands.range() == ([-1.0] * 7, [1.0] * 7)


def test_joint_without_safety_controller_is_named() -> None:
    commands = JointCommands(RobotState(), NAMES)
    joints = [joint(name, with_safety=name != "a_joint3") for name in NAMES]
    assert commands.add_limits(joints, rate_limits_of(PANDA_LIMITS)) == ["a_joint3"]
