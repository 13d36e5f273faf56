"""The typed Python client of a station, for scripts, tools and the dashboard.

```python
from station.client import StationClient

with StationClient("http://127.0.0.1:8000", token) as client:
    client.load_controller("arm", "effort_controllers/JointGroupPositionController")
    client.switch_controllers(start=["arm"])
    for frame in client.stream("joint_states", rate=60):
        print(frame.stamp, frame.data["position"])
```
"""

from station.client._async.gripper_client import AsyncGripperClient
from station.client._async.robot_client import AsyncRobotClient
from station.client._async.simulation_client import AsyncSimulationClient
from station.client._async.station_client import AsyncStationClient
from station.client._sync.gripper_client import GripperClient
from station.client._sync.robot_client import RobotClient
from station.client._sync.simulation_client import SimulationClient
from station.client._sync.station_client import StationClient
from station.client.async_stream import AsyncStream
from station.client.errors import ApiError, StationUnreachableError
from station.client.stream import Stream

__all__ = [
    "ApiError",
    "AsyncGripperClient",
    "AsyncRobotClient",
    "AsyncSimulationClient",
    "AsyncStationClient",
    "AsyncStream",
    "GripperClient",
    "RobotClient",
    "SimulationClient",
    "StationClient",
    "StationUnreachableError",
    "Stream",
]
