"""Controllers that close a PID loop around every joint."""

from station.controllers.pid_command_controller.joint_pid_controller import (
    JointPidController,
    position_error,
)
from station.controllers.pid_command_controller.joint_pid_group import (
    JointPidGroup,
    read_pid_gains,
)

__all__ = ["JointPidController", "JointPidGroup", "position_error", "read_pid_gains"]
