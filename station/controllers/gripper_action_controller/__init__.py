"""Grippers with one joint, moved by goals.

One module per package of the original in which the class is called
`GripperActionController`.
"""

from station.controllers.gripper_action_controller.gripper_action_controller import (
    GripperActionControllerBase,
)

__all__ = ["GripperActionControllerBase"]
