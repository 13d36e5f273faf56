"""Controllers that close a PID loop around every joint."""

from station.controllers.pid_command_controller.joint_pids import (
    JointPids,
    read_joint_pids,
)
from station.controllers.pid_command_controller.position_pid_controller import (
    PositionPidController,
)

__all__ = ["JointPids", "PositionPidController", "read_joint_pids"]
