"""Open and close grippers with one joint by goals."""

from station.controllers.gripper_action_controller.gripper_action_controller import (
    EffortGripperActionController,
    GripperActionController,
    PositionGripperActionController,
)

__all__ = [
    "EffortGripperActionController",
    "GripperActionController",
    "PositionGripperActionController",
]
