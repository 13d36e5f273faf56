"""Actuator handles and interfaces: the motor side of a transmission.

They correspond to the joint handles and interfaces, on the motor side of the gears.
Asking for a handle claims nothing, because actuators are claimed through their joints.

Source: ros_control@633c374 hardware_interface/actuator_state_interface.h,
actuator_command_interface.h; differs: a "pointer" is a list of floats and an index.
"""

from typing import ClassVar

from station.core.hardware.interfaces.joint import JointHandle, JointStateHandle
from station.core.hardware.interfaces.resource_manager import HardwareResourceManager


class ActuatorStateHandle(JointStateHandle):
    """Reads the state of one actuator.

    Arguments, storage and errors are those of `JointStateHandle`. Positions, velocities
    and efforts are those of the motor's shaft.
    """


class ActuatorHandle(JointHandle):
    """Reads the state of one actuator and commands it with one value.

    Arguments, storage and errors are those of `JointHandle`.
    """


class ActuatorStateInterface(HardwareResourceManager[ActuatorStateHandle]):
    """Actuator states; reading claims nothing."""

    type_name: ClassVar[str] = "hardware_interface::ActuatorStateInterface"


class ActuatorCommandInterface(HardwareResourceManager[ActuatorHandle]):
    """Actuator commands of one kind; asking for a handle claims nothing."""

    type_name: ClassVar[str] = "hardware_interface::ActuatorCommandInterface"


class EffortActuatorInterface(ActuatorCommandInterface):
    """Effort commands [Nm or N]."""

    type_name: ClassVar[str] = "hardware_interface::EffortActuatorInterface"


class VelocityActuatorInterface(ActuatorCommandInterface):
    """Velocity commands [rad/s or m/s]."""

    type_name: ClassVar[str] = "hardware_interface::VelocityActuatorInterface"


class PositionActuatorInterface(ActuatorCommandInterface):
    """Position commands [rad or m]."""

    type_name: ClassVar[str] = "hardware_interface::PositionActuatorInterface"
