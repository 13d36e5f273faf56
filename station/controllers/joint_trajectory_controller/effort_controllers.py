"""Trajectories by effort commands.

Source: ros_controllers@678b92a joint_trajectory_controller/
hardware_interface_adapter.h.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.joint_trajectory_controller.closed_loop_controller import (
    ClosedLoopTrajectoryController,
)
from station.core.hardware.interfaces import EffortJointInterface


class JointTrajectoryController(ClosedLoopTrajectoryController[EffortJointInterface]):
    """Commands effort from the errors of position and velocity."""

    hardware_interface: ClassVar[type] = EffortJointInterface
    command_quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT
