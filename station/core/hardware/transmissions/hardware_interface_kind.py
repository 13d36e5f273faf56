"""The interfaces that each `<hardwareInterface>` of a joint stands for.

Source: ros_control@633c374 transmission_interface/ros_control_plugins.xml and the
providers of joint interfaces that it lists.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from station.core.hardware.interfaces.interface_manager import InterfaceManager
from station.core.hardware.interfaces.joint import (
    ActuatorCommandInterface,
    EffortActuatorInterface,
    EffortJointInterface,
    JointCommandInterface,
    PositionActuatorInterface,
    PositionJointInterface,
    VelocityActuatorInterface,
    VelocityJointInterface,
)
from station.core.hardware.transmissions.transmission_interface import (
    ActuatorToJointEffortInterface,
    ActuatorToJointPositionInterface,
    ActuatorToJointVelocityInterface,
    JointToActuatorEffortInterface,
    JointToActuatorPositionInterface,
    JointToActuatorVelocityInterface,
    TransmissionInterface,
)

_Interface = TypeVar("_Interface")


def interface_of(
    manager: InterfaceManager, interface_type: type[_Interface]
) -> _Interface:
    """Return an interface of a manager; register a new one if it has none.

    Args:
        manager: A robot or its transmissions.
        interface_type: Type of the interface; it is constructed without arguments.

    Returns:
        The interface.
    """
    interface = manager.get(interface_type)
    if interface is None:
        interface = interface_type()
        manager.register_interface(interface)
    return interface


@dataclass(frozen=True, slots=True)
class CommandKind:
    """The interfaces that belong to one kind of command.

    Attributes:
        quantity: "position", "velocity" or "effort".
        joint_interface: The interface through which controllers command joints.
        actuator_interface: The interface through which the robot offers its actuators.
        to_actuator: Carries joint commands to actuator commands.
        to_joint: Carries actuator commands back to joint commands.
    """

    quantity: str
    joint_interface: type[JointCommandInterface]
    actuator_interface: type[ActuatorCommandInterface]
    to_actuator: type[TransmissionInterface]
    to_joint: type[TransmissionInterface]


_POSITION = CommandKind(
    "position",
    PositionJointInterface,
    PositionActuatorInterface,
    JointToActuatorPositionInterface,
    ActuatorToJointPositionInterface,
)
_VELOCITY = CommandKind(
    "velocity",
    VelocityJointInterface,
    VelocityActuatorInterface,
    JointToActuatorVelocityInterface,
    ActuatorToJointVelocityInterface,
)
_EFFORT = CommandKind(
    "effort",
    EffortJointInterface,
    EffortActuatorInterface,
    JointToActuatorEffortInterface,
    ActuatorToJointEffortInterface,
)

HARDWARE_INTERFACES: Mapping[str, tuple[CommandKind | None, bool]] = {
    "hardware_interface/JointStateInterface": (None, False),
    "hardware_interface/PositionJointInterface": (_POSITION, False),
    "hardware_interface/VelocityJointInterface": (_VELOCITY, False),
    "hardware_interface/EffortJointInterface": (_EFFORT, False),
    "hardware_interface/BiDirectionalPositionJointInterface": (_POSITION, True),
    "hardware_interface/BiDirectionalVelocityJointInterface": (_VELOCITY, True),
    "hardware_interface/BiDirectionalEffortJointInterface": (_EFFORT, True),
}
"""By name of a `<hardwareInterface>`: the kind of command, None for state only, and
whether values are carried in both directions."""
