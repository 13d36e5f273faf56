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

from station.client.blocking import (
    AgentsClient as AgentsClient,
    AlarmsClient as AlarmsClient,
    BenchRunsClient as BenchRunsClient,
    CamerasClient as CamerasClient,
    ExperimentsClient as ExperimentsClient,
    GainSetsClient as GainSetsClient,
    GoalHandle as GoalHandle,
    GripperClient as GripperClient,
    IncidentsClient as IncidentsClient,
    LeaseClient as LeaseClient,
    LessonsClient as LessonsClient,
    PlotLayoutsClient as PlotLayoutsClient,
    RecordingsClient as RecordingsClient,
    RobotClient as RobotClient,
    ScenesClient as ScenesClient,
    SimulationClient as SimulationClient,
    StationClient as StationClient,
    TokensClient as TokensClient,
    WaypointPathsClient as WaypointPathsClient,
)
from station.client.blocking_streams import Stream as Stream
from station.client.connection import RequestDeadline as RequestDeadline
from station.client.controllers import AsyncGoalHandle as AsyncGoalHandle
from station.client.errors import (
    ApiError as ApiError,
    EmptyNameError as EmptyNameError,
    MotionError as MotionError,
    NotFiniteError as NotFiniteError,
    StationUnreachableError as StationUnreachableError,
    StreamTimeoutError as StreamTimeoutError,
)
from station.client.poses import (
    POSES as POSES,
    Pose as Pose,
    UnknownPoseError as UnknownPoseError,
)
from station.client.robots import (
    AsyncGripperClient as AsyncGripperClient,
    AsyncRobotClient as AsyncRobotClient,
    AsyncSimulationClient as AsyncSimulationClient,
)
from station.client.samples import Samples as Samples
from station.client.station_client import AsyncStationClient as AsyncStationClient
from station.client.streams import AsyncStream as AsyncStream
from station.local.station_locator import NoStationError as NoStationError
