"""A station over a mock robot of two joints that follows trajectories."""

from station.core.clock import ManualClock
from station.core.facade.station import Station
from station.testing import Bench

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
    station = Bench(
        robot_parameters={"joints": JOINTS},
        root_parameters={"robot_description": URDF},
        clock=clock,
    ).make_station()
    for name, kind in CONTROLLER_TYPES.items():
        station.load_controller(name, kind, {"joints": JOINTS, **parameters})
    return station
