"""Pass data between the control thread and others without making it wait."""

from station.core.toolbox.realtime.realtime_box import RealtimeBox
from station.core.toolbox.realtime.realtime_buffer import RealtimeBuffer
from station.core.toolbox.realtime.realtime_clock import RealtimeClock
from station.core.toolbox.realtime.realtime_publisher import RealtimePublisher
from station.core.toolbox.realtime.realtime_server_goal_handle import (
    RealtimeServerGoalHandle,
)

__all__ = [
    "RealtimeBox",
    "RealtimeBuffer",
    "RealtimeClock",
    "RealtimePublisher",
    "RealtimeServerGoalHandle",
]
