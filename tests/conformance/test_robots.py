"""Every robot of the table conforms, unasked."""

from functools import partial

import pytest

from station.hw import HARDWARE
from station.hw.robot_loader import create_robot
from station.testing import RobotConformance
from tests.conformance.benches import JOINTS, robot_bench

IMPOSSIBLE = {"joints": 3, "robot_hardware": 3, "arm_id": 3}


class TestEveryRobot(RobotConformance):
    """The suite, over the table of robots."""

    joints = JOINTS
    impossible = IMPOSSIBLE

    @pytest.fixture(params=HARDWARE)
    def robot_type(self, request):
        return request.param

    @pytest.fixture
    def make_robot(self, robot_type):
        return partial(create_robot, robot_type)

    @pytest.fixture
    def bench(self, robot_type):
        return robot_bench(robot_type)
