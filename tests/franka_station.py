"""A station over one simulated arm, stepped by hand."""

from collections.abc import Sequence

from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.facade.station import Station
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.hw.franka.franka_hw import FrankaHW

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]


def make_franka_station(*, objects: Sequence[object] = (), **robot: object) -> Station:
    """Return a station with the position controller `arm`, which does not run.

    Args:
        objects: What stands around the robot, as in the configuration.
        robot: More parameters of the robot.
    """
    tree, clock, hw = Parameters(), ManualClock(), FrankaHW()
    tree.set("scene", {"objects": list(objects)})
    tree.set(
        "robot",
        {"arm_id": "panda", "robot_description": "example-robot-data:panda", **robot},
    )
    hw.init(tree, tree.namespace("robot"))
    manager = ControllerManager(hw, tree, [TableLoader(CONTROLLERS)], clock)
    station = Station(ControlLoop(hw, manager, clock=clock), manager, tree)
    group = "position_controllers/JointGroupPositionController"
    station.load_controller("arm", group, {"joints": JOINTS})
    station.loop.step()
    return station
