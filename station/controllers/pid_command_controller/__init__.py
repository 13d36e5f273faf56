"""Controllers that close a PID loop around every joint."""

from station.controllers.pid_command_controller.joint_pid_controller import (
    JointPidController,
    set_ways,
)
from station.controllers.pid_command_controller.joint_pid_group import (
    JointPidGroup,
    pid_parameters,
    read_pid_gains,
)

__all__ = [
    "JointPidController",
    "JointPidGroup",
    "pid_parameters",
    "read_pid_gains",
    "set_ways",
]
