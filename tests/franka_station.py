"""A station over one simulated arm, stepped by hand."""

from collections.abc import Sequence

from station.core.facade.station import Station
from station.hw.franka.franka_hw import FrankaHW
from station.testing import Bench

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]


def make_franka_station(*, objects: Sequence[object] = (), **robot: object) -> Station:
    """Return a station with the position controller `arm`, which does not run.

    Args:
        objects: What stands around the robot, as in the configuration.
        robot: More parameters of the robot, which is ideal unless they say otherwise.
    """
    station = Bench(
        FrankaHW(),
        {
            "arm_id": "panda",
            "robot_description": "example-robot-data:panda",
            "realism": "ideal",
            **robot,
        },
        root_parameters={"scene": {"objects": list(objects)}},
    ).make_station()
    group = "position_controllers/JointGroupPositionController"
    station.load_controller("arm", group, {"joints": JOINTS})
    station.loop.step()
    return station
