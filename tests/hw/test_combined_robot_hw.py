"""The configured combination makes its robots from the types the station knows."""

import pytest

from station.core.errors import StationError
from station.core.hardware.interfaces import JointStateInterface
from station.core.parameters import Parameters
from station.hw.robot_loader import create_robot


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
