"""A station over two simulated arms with one of the examples, stepped by hand."""

from collections.abc import Mapping

from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.hw.robot_loader import create_robot


def joints_of(arm_id: str) -> list[str]:
    """Return the names of the joints of an arm."""
    return [f"{arm_id}_joint{number}" for number in range(1, 8)]


def start_two_armed_example(
    kind: str, params: Mapping[str, object], arms: Mapping[str, Mapping[str, object]]
) -> Station:
    """Return a station in which the example has just been started.

    Args:
        kind: Its name without `ExampleController`.
        params: Its parameters.
        arms: By arm_id: more parameters of the arm.
    """
    tree, clock = Parameters(), ManualClock()
    robot: dict[str, object] = {"robot_hardware": list(arms)}
    for arm_id, values in arms.items():
        robot[arm_id] = {
            "arm_id": arm_id,
            "realism": "ideal",
            "robot_description": "example-robot-data:panda",
            "cutoff_frequency": 1000.0,
            **values,
        }
    tree.set("robot", robot)
    hw = create_robot("franka_hw/FrankaCombinedHW")
    hw.init(tree, tree.namespace("robot"))
    manager = ControllerManager(hw, tree, [TableLoader(CONTROLLERS)], clock)
    station = Station(ControlLoop(hw, manager, clock=clock), manager, tree)
    kind = f"franka_example_controllers/{kind}ExampleController"
    station.load_controller("example", kind, dict(params))
    station.loop.step()
    station.switch_controllers(SwitchRequest(("example",), ()))
    return station
