"""A robot is found by its type."""

import sys
import types

import pytest

from station.core.hardware.robot_hw import RobotHW
from station.hw.robot_loader import RobotTypeError, create_robot


class MyRobotHW(RobotHW):
    """A robot of somebody's own."""


def test_robot_of_the_table_is_created():
    robot = create_robot("franka_hw/FrankaHW")

    assert isinstance(robot, RobotHW)
    assert type(robot).__name__ == "FrankaHW"


def test_class_is_named_by_its_module(monkeypatch):
    module = types.ModuleType("my_hw")
    module.MyRobotHW = MyRobotHW
    monkeypatch.setitem(sys.modules, "my_hw", module)

    assert type(create_robot("my_hw:MyRobotHW")) is MyRobotHW


@pytest.mark.parametrize(
    ("robot_type", "message"),
    [
        ("other_hw/Other", "allowed are .*franka_hw/FrankaHW"),
        ("no_such_module:Robot", "cannot be imported"),
        ("station.core.hardware.robot_hw:Nothing", "cannot be imported"),
        ("collections:OrderedDict", "is not a RobotHW"),
    ],
)
def test_anything_else_is_refused(robot_type, message):
    with pytest.raises(RobotTypeError, match=message):
        create_robot(robot_type)
