"""PIDs that controllers of ROS 2 put between references and commands."""

from station.controllers.pid_controller.pid_controller import (
    PidController as PidController,
)
