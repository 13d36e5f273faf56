"""The typed Python client of a station, for scripts, tools and the dashboard.

```python
from station.client import StationClient

with StationClient() as station:  # the one on this machine
    station.move_to("ready")
    station.robot().gripper.close()
    samples = station.collect(2.0)
    print(samples.stamp, samples["position"])
```
"""

from station.client._async.goal_handle import AsyncGoalHandle
from station.client._async.gripper_client import AsyncGripperClient
from station.client._async.robot_client import AsyncRobotClient
from station.client._async.simulation_client import AsyncSimulationClient
from station.client._async.station_client import AsyncStationClient
from station.client._sync.goal_handle import GoalHandle
from station.client._sync.gripper_client import GripperClient
from station.client._sync.robot_client import RobotClient
from station.client._sync.simulation_client import SimulationClient
from station.client._sync.station_client import StationClient
from station.client.async_stream import AsyncStream
from station.client.errors import (
    ApiError,
    MotionError,
    StationUnreachableError,
    StreamTimeoutError,
)
from station.client.poses import POSES, Pose, UnknownPoseError
from station.client.samples import Samples
from station.client.stream import Stream
from station.local.station_locator import NoStationError

__all__ = [
    "POSES",
    "ApiError",
    "AsyncGoalHandle",
    "AsyncGripperClient",
    "AsyncRobotClient",
    "AsyncSimulationClient",
    "AsyncStationClient",
    "AsyncStream",
    "GoalHandle",
    "GripperClient",
    "MotionError",
    "NoStationError",
    "Pose",
    "RobotClient",
    "Samples",
    "SimulationClient",
    "StationClient",
    "StationUnreachableError",
    "Stream",
    "StreamTimeoutError",
    "UnknownPoseError",
]
