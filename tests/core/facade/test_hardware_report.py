"""Interfaces, and who claims what."""

from station.core.control.controller import ControllerState
from station.core.control.controller_status import ControllerStatus
from station.core.facade.hardware_report import report_hardware
from station.core.hardware.robot_hw import InterfaceResources
from station.core.parameters import Parameters, ParameterTree
from station.hw.combined_robot_hw import CombinedRobotHW
from station.hw.mock import MockRobotHW
from station.reports import Percentiles

EFFORT = "hardware_interface::EffortJointInterface"


def make_robot() -> MockRobotHW:
    robot = MockRobotHW()
    robot.init(Parameters(), Parameters())
    return robot


def controller(name: str, state: ControllerState, *joints: str) -> ControllerStatus:
    claims = (InterfaceResources(EFFORT, joints),)
    time = Percentiles(0.0, 0.0, 0.0, 0.0, 0)
    return ControllerStatus(name, "test/C", state, claims, None, None, (), time)


def test_running_controllers_claim_and_others_do_not():
    report = report_hardware(
        make_robot(),
        [
            controller("arm", ControllerState.RUNNING, "joint1"),
            controller("idle", ControllerState.STOPPED, "joint2"),
        ],
    )
    (found,) = [i for i in report.interfaces if i.name == EFFORT]
    assert [(r.name, r.claimed_by) for r in found.resources] == [
        ("joint1", ("arm",)),
        ("joint2", ()),
    ]


def test_robot_without_limits_tells_none():
    report = report_hardware(make_robot(), [])
    assert (report.limits, report.transmissions, report.clamps) == ((), (), ())


def test_combined_robot_tells_what_its_robots_tell():
    robot = {
        "robot_hardware": ["left", "right"],
        "left": {"type": "mock_hw/MockRobotHW", "joints": ["l"]},
        "right": {
            "type": "mujoco_hw/MujocoRobotHW",
            "robot_description": "example-robot-data:ur5",
            "floor": False,
        },
    }
    tree = ParameterTree({"robot": robot})
    hw = CombinedRobotHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    report = report_hardware(hw, [])
    assert [limits.joint for limits in report.limits][:2] == [
        "shoulder_pan_joint",
        "shoulder_lift_joint",
    ]
    assert len(report.transmissions) == 6
    (found,) = [i for i in report.interfaces if i.name == EFFORT]
    assert "l" in [r.name for r in found.resources]
