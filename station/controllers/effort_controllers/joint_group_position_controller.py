"""Hold positions with efforts, one PID per joint.

Source: ros_controllers@678b92a effort_controllers/src/
joint_group_position_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.pid_command_controller import PositionPidController
from station.core.hardware.interfaces import EffortJointInterface


class JointGroupPositionController(PositionPidController[EffortJointInterface]):
    """Position control of a group of effort-controlled joints.

    Parameters: `joints`, and per joint `<joint>/pid` with `p`, `i`, `d`, `i_clamp`
    (or `i_clamp_min` and `i_clamp_max`) and `antiwindup`. `robot_description` in this
    or an outer namespace gives types and limits of the joints.
    """

    hardware_interface: ClassVar[type] = EffortJointInterface
    command_quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT
