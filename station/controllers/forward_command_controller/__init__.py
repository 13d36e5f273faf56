"""Controllers that pass set-points on, and what all set-point controllers share."""

from station.controllers.forward_command_controller.forward_command_controller import (
    ForwardCommandController,
)
from station.controllers.forward_command_controller.forward_joint_group_command_controller import (  # noqa: E501
    ForwardJointGroupCommandController,
)
from station.controllers.forward_command_controller.joint_quantity import JointQuantity
from station.controllers.forward_command_controller.joint_set_point_controller import (
    JointSetPointController,
)

__all__ = [
    "ForwardCommandController",
    "ForwardJointGroupCommandController",
    "JointQuantity",
    "JointSetPointController",
]
