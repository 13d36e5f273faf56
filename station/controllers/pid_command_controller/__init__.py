"""Controllers that close a PID loop around every joint."""

from station.controllers.pid_command_controller.joint_pid_controller import (
    JointPidController,
)
from station.controllers.pid_command_controller.joint_pids import (
    JointPids,
    read_joint_pids,
)
from station.controllers.pid_command_controller.position_pid_controller import (
    PositionPidController,
    position_error,
)

__all__ = [
    "JointPidController",
    "JointPids",
    "PositionPidController",
    "position_error",
    "read_joint_pids",
]
