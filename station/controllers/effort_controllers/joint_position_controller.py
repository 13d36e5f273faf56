"""Hold the position of one joint with efforts from a PID.

Source: ros_controllers@678b92a effort_controllers/src/joint_position_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.pid_command_controller import PositionPidController
from station.core.hardware.interfaces import EffortJointInterface


class JointPositionController(PositionPidController[EffortJointInterface]):
    """Position control of one effort-controlled joint.

    Parameters: `joint`, and `pid` with `p`, `i`, `d`, `i_clamp` (or `i_clamp_min` and
    `i_clamp_max`) and `antiwindup`. `robot_description` in this or an outer namespace
    gives type and limits of the joint.
    """

    hardware_interface: ClassVar[type] = EffortJointInterface
    command_quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT
    is_group: ClassVar[bool] = False
