"""The table of robot types."""

from importlib import import_module

import pytest

from station.core.hardware.robot_hw import RobotHW
from station.hw import HARDWARE


@pytest.mark.parametrize("robot_type", HARDWARE)
def test_every_entry_names_a_robot(robot_type: str) -> None:
    module, _, name = HARDWARE[robot_type].partition(":")
    robot = getattr(import_module(module), name)
    assert issubclass(robot, RobotHW)
    assert robot_type.endswith(f"/{name}")
