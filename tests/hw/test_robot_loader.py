"""A robot is found by its type."""

import sys
import types

import pytest

from station.core.errors import StationError
from station.core.hardware.interfaces import JointStateInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
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


def combination(robot_type):
    params = Parameters()
    params.set("robot_hardware", ["left"])
    params.set("left", {"type": robot_type, "joints": ["l1"]})
    robot = create_robot("combined_robot_hw/CombinedRobotHW")
    robot.init(params, params)
    return robot


def test_robots_of_the_table_are_combined():
    robot = combination("mock_hw/MockRobotHW")

    assert robot.get(JointStateInterface).get_names() == ["l1"]


def test_an_unknown_type_is_refused():
    with pytest.raises(StationError, match="nope/Nope"):
        combination("nope/Nope")
