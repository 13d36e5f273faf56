"""Hold the velocity of one joint with efforts from a PID.

Source: ros_controllers@678b92a effort_controllers/src/joint_velocity_controller.cpp.
"""

from typing import ClassVar

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.pid_command_controller import JointPidController
from station.core.hardware.interfaces import EffortJointInterface


class JointVelocityController(JointPidController[EffortJointInterface]):
    """Velocity control of one effort-controlled joint; starts with zero velocity.

    Parameters: `joint`, and `pid` with `p`, `i`, `d`, `i_clamp` (or `i_clamp_min` and
    `i_clamp_max`) and `antiwindup`.
    """

    hardware_interface: ClassVar[type] = EffortJointInterface
    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY
    command_quantity: ClassVar[JointQuantity] = JointQuantity.EFFORT
    is_group: ClassVar[bool] = False
