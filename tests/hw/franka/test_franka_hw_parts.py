"""Parts of FrankaHW: interfaces, periods of the loop, joints close to a limit."""

import logging

import pytest

from station.core.clock import ManualClock
from station.core.control.controller_manager import ControllerManager
from station.core.description.robot_files import load_robot_files
from station.core.errors import HardwareInterfaceError
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.franka_hw import (
    FrankaHW,
    arm_cycles_of,
    joint_limit_warnings,
    model_interface,
    state_interface,
)
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.hw.urdf_loader import load_urdf


def test_names_are_upstreams():
    description = load_robot_files("example-robot-data:panda")
    arm = simulate([ArmPlacement("panda", description)]).arms["panda"]

    model = arm.load_model()
    assert state_interface(arm, "panda", model).get_names() == ["panda_robot"]
    models = model_interface(arm, "panda", model)
    assert models.get_names() == ["panda_model", "panda_robot"]


def test_joint_close_to_a_limit_is_named():
    urdf = load_urdf(load_robot_files("example-robot-data:panda"))
    joint = urdf.joints["panda_joint1"]

    assert joint_limit_warnings([joint], [0.0], 0.1) == []
    assert joint_limit_warnings([joint], [-2.85], 0.1) == [
        "panda_joint1 is 2.7 degrees from a limit"
    ]


@pytest.mark.parametrize(("period", "cycles"), [(0.001, 1), (0.0015, 2), (0.004, 4)])
def test_slower_loop_has_several_cycles_of_the_arm(period, cycles):
    assert arm_cycles_of(period, 0.001, "panda") == cycles


def test_loop_faster_than_the_arm_is_refused():
    with pytest.raises(HardwareInterfaceError, match="2000 Hz; arm 'panda'") as error:
        arm_cycles_of(0.0005, 0.001, "panda")
    assert "1000 or less" in error.value.remedy


def test_loop_too_slow_for_torques_is_warned_of(caplog):
    with caplog.at_level(logging.WARNING):
        arm_cycles_of(0.01, 0.001, "panda")
    assert "100 Hz" in caplog.text


class Watched(FrankaHW):
    """Notes in every cycle that it is asked."""

    def __init__(self):
        super().__init__()
        self.asked = []

    def read(self, time, period):
        self.asked.append("read")
        super().read(time, period)

    def write(self, time, period):
        self.asked.append("write")
        super().write(time, period)

    def mode(self):
        self.asked.append("mode")
        return super().mode()


def test_a_loop_calls_what_a_subclass_replaces():
    robot, clock = Watched(), ManualClock()
    arm = {"arm_id": "panda", "robot_description": "example-robot-data:panda"}
    tree = ParameterTree({"robot": arm})
    robot.init(Parameters(tree), Parameters(tree, "robot"))
    manager = ControllerManager(robot, Parameters(), [], clock)

    ControlLoop(robot, manager, clock=clock).step(2)

    assert robot.asked == ["read", "write", "mode"] * 2
