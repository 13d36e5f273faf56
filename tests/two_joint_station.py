"""A station over a mock robot of two joints that follows trajectories."""

from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.facade.station import Station
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW

URDF = """
<robot name="two">
  <joint name="j1" type="revolute">
    <limit lower="-2" upper="2" velocity="2" effort="80"/>
  </joint>
  <joint name="j2" type="revolute">
    <limit lower="-2" upper="2" velocity="2" effort="80"/>
  </joint>
</robot>
"""
JOINTS = ["j1", "j2"]
TRAJECTORY = {
    "joint_names": JOINTS,
    "points": [{"time_from_start": 0.5, "positions": [0.4, -0.4]}],
}
CONTROLLER_TYPES = {
    "arm": "position_controllers/JointTrajectoryController",
    "group": "position_controllers/JointGroupPositionController",
}


def make_station(*, clock: ManualClock | None = None, **parameters) -> Station:
    """Return a station with the controllers `arm` and `group`, none of them running.

    Args:
        clock: The station's clock.
        parameters: More parameters of both.
    """
    clock, tree, hw = clock or ManualClock(), Parameters(), MockRobotHW()
    tree.set("hw/joints", JOINTS)
    tree.set("robot_description", URDF)
    hw.init(tree, tree.namespace("hw"))
    manager = ControllerManager(hw, tree, [TableLoader(CONTROLLERS)], clock)
    station = Station(ControlLoop(hw, manager, clock=clock), manager, tree)
    for name, kind in CONTROLLER_TYPES.items():
        station.load_controller(name, kind, {"joints": JOINTS, **parameters})
    return station
