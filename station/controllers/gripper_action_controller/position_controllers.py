"""Grippers by position commands.

Source: ros_controllers@678b92a gripper_action_controller/hardware_interface_adapter.h.
"""

from typing import ClassVar

from typing_extensions import override

from station.controllers.gripper_action_controller.gripper_action_controller import (
    GripperActionControllerBase,
)
from station.controllers.gripper_action_controller.gripper_command_port import (
    GripperCommand,
)
from station.core.hardware.interfaces import JointHandle, PositionJointInterface


class GripperActionController(GripperActionControllerBase[PositionJointInterface]):
    """Commands the position of the goal; the hardware decides about the effort."""

    hardware_interface: ClassVar[type] = PositionJointInterface

    @override
    def command(
        self, handle: JointHandle, target: GripperCommand, period: float
    ) -> float:
        handle.set_command(target.position)
        return target.position
