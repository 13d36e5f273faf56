"""Every controller of the table conforms, unasked."""

from functools import partial

import pytest

from station.controllers import CONTROLLERS
from station.testing import ControllerConformance
from tests.conformance.benches import JOINTS, POSE, bench_for, robot_bench


class TestEveryController(ControllerConformance):
    """The suite, over the table of controllers."""

    obeys_command_timeout = True

    @pytest.fixture(params=CONTROLLERS, autouse=True)
    def controller_type(self, request):
        self.controller = request.param
        return request.param

    @pytest.fixture
    def load(self, controller_type):
        return partial(bench_for, controller_type)

    def make_robot_bench(self):
        return robot_bench()

    def resting_set_point(self, bench):
        elements = bench.manager.get_controller("it").set_points.elements
        names = [element.name for element in elements]
        if "qw" in names:
            pose = {"qx": 1.0, "x": 0.307, "z": 0.487}
            return [pose.get(name, 0.0) for name in names]
        return [
            POSE[JOINTS.index(element.name)] if element.unit == "rad" else 0.0
            for element in elements
        ]
