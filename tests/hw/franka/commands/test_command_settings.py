"""What the arm is told for each mode."""

from dataclasses import replace

import pytest

from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.arm.robot_arm import ControllerMode, MotionGeneratorMode
from station.hw.franka.commands.rate_limiter import CommandSettings

SETTINGS = CommandSettings(
    rate_limiting=True,
    cutoff_frequency=100.0,
    internal_controller=ControllerMode.CARTESIAN_IMPEDANCE,
)


@pytest.mark.parametrize(
    ("mode", "controller", "generator"),
    [
        (1, ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.NONE),
        (2, SETTINGS.internal_controller, MotionGeneratorMode.JOINT_POSITION),
        (5, ControllerMode.EXTERNAL_CONTROLLER, MotionGeneratorMode.JOINT_VELOCITY),
        (8, SETTINGS.internal_controller, MotionGeneratorMode.CARTESIAN_VELOCITY),
        (
            17,
            ControllerMode.EXTERNAL_CONTROLLER,
            MotionGeneratorMode.CARTESIAN_POSITION,
        ),
    ],
)
def test_torque_command_replaces_the_internal_controller(mode, controller, generator):
    joint = ControllerMode.JOINT_IMPEDANCE
    assert SETTINGS.arm_modes(ControlMode(mode), joint) == (controller, generator)


@pytest.mark.parametrize(
    ("mode", "set_last", "acts"),
    [
        (8, "joint", "joint"),
        (8, "cartesian", "cartesian"),
        (16, "cartesian", "cartesian"),
        (2, "cartesian", "joint"),
        (4, "cartesian", "joint"),
    ],
)
def test_impedance_that_was_set_last_acts_in_cartesian_motions(mode, set_last, acts):
    settings = replace(SETTINGS, internal_controller=None)
    impedance = ControllerMode(f"{set_last}_impedance")
    controller, _ = settings.arm_modes(ControlMode(mode), impedance)
    assert controller is ControllerMode(f"{acts}_impedance")
