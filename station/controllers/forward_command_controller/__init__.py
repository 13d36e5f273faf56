"""Controllers that forward set-points, and what all set-point controllers share."""

from station.controllers.forward_command_controller.controlled_joints import (
    ControlledJoints,
)
from station.controllers.forward_command_controller.forward_command_controller import (
    ForwardCommandController,
    ForwardJointGroupCommandController,
)
from station.controllers.forward_command_controller.joint_quantity import JointQuantity
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
    JointSetPointController,
)

__all__ = [
    "CommandInterfaceT",
    "ControlledJoints",
    "ForwardCommandController",
    "ForwardJointGroupCommandController",
    "JointQuantity",
    "JointSetPointController",
]
