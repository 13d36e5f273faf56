"""Hold the position of one joint with velocities from a PID.

Source: ros_controllers@678b92a velocity_controllers/src/joint_position_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.pid_command_controller import PositionPidController
from station.core.hardware.interfaces import VelocityJointInterface


class JointPositionController(PositionPidController[VelocityJointInterface]):
    """Position control of one velocity-controlled joint.

    Parameters: `joint`, and `pid` with `p`, `i`, `d`, `i_clamp` (or `i_clamp_min` and
    `i_clamp_max`) and `antiwindup`. `robot_description` in this or an outer namespace
    gives type and limits of the joint.
    """

    hardware_interface: ClassVar[type] = VelocityJointInterface
    command_quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY
    is_group: ClassVar[bool] = False
