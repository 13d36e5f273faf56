"""The bench runs one robot and its controllers by hand."""

import pytest

from station.controllers import CONTROLLERS
from station.core import Controller, EffortJointInterface, ParameterError
from station.testing.bench import Bench

GROUP = "effort_controllers/JointGroupEffortController"


class Push(Controller[EffortJointInterface]):
    """Pushes a joint with 1 Nm."""

    hardware_interface = EffortJointInterface

    def init(self, interface, params):
        self.joint = interface.get_handle(params.get_str("joint"))

    def update(self, time, period):
        self.joint.set_command(1.0)


def test_a_class_is_loaded_without_a_type_name():
    bench = Bench()

    bench.load_controller("push", Push, joint="joint1")
    assert bench.switch(["push"]).ok
    bench.step(2)

    assert bench.commands().count(1.0) == 1
    assert bench.state("push") == "running"
    assert bench.fault("push") is None


def test_the_types_of_the_station_are_known():
    assert GROUP in CONTROLLERS
    bench = Bench()

    controller = bench.load_controller("group", GROUP, joints=["joint1", "joint2"])

    assert controller is bench.manager.get_controller("group")


def test_time_stands_still_in_a_pause():
    bench = Bench(period=0.01)
    bench.step(3)

    bench.pause(5)

    assert bench.time == pytest.approx(0.03)
    assert bench.manager.cycle == 8


def test_a_station_over_the_bench_runs_the_same_controllers():
    bench = Bench()
    bench.load_controller("push", Push, joint="joint1")

    station = bench.make_station()
    station.loop.step(3)

    assert [one.name for one in station.controllers()] == ["push"]
    assert station.loop.cycle == bench.manager.cycle == 3


def test_impossible_parameters_of_the_robot_are_refused():
    with pytest.raises(ParameterError, match="joints"):
        Bench(robot_parameters={"joints": 3})
