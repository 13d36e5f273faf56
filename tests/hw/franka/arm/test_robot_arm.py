"""The seam: every arm answers everything that libfranka's robot does here."""

import inspect

import pytest

from station.core.errors import ArmCommandError
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.simulated.simulated_arm import SimulatedArm


def test_arm_without_the_methods_cannot_be_made() -> None:
    with pytest.raises(TypeError, match="abstract"):
        RobotArm()


def test_simulated_arm_keeps_the_signatures() -> None:
    for name in RobotArm.__abstractmethods__:
        expected = inspect.signature(getattr(RobotArm, name)).parameters
        assert inspect.signature(getattr(SimulatedArm, name)).parameters == expected


def test_refusal_carries_its_code() -> None:
    assert ArmCommandError("no").code == "arm_command_refused"
