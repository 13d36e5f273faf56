"""Forward effort commands to one joint.

Source: ros_controllers@678b92a effort_controllers/src/
joint_effort_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import (
    ForwardCommandController,
    JointQuantity,
)
from station.core.hardware.interfaces import EffortJointInterface


class JointEffortController(ForwardCommandController[EffortJointInterface]):
    """Forwards effort commands to the parameter `joint`."""

    hardware_interface: ClassVar[type] = EffortJointInterface
    quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT
