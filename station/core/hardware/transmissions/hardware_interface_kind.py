"""Know which interfaces a `<hardwareInterface>` of a joint stands for.

Source: ros_control@633c374 transmission_interface/ros_control_plugins.xml and the
providers of joint interfaces that it lists.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from station.core.hardware.interfaces.actuator import (
    ActuatorCommandInterface,
    EffortActuatorInterface,
    PositionActuatorInterface,
    VelocityActuatorInterface,
)
from station.core.hardware.interfaces.interface_manager import InterfaceManager
from station.core.hardware.interfaces.joint import (
    EffortJointInterface,
    JointCommandInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.transmissions.transmission import Transmission
from station.core.hardware.transmissions.transmission_handle import (
    ActuatorData,
    ActuatorToJointEffortHandle,
    ActuatorToJointPositionHandle,
    ActuatorToJointStateHandle,
    ActuatorToJointVelocityHandle,
    JointData,
    JointToActuatorEffortHandle,
    JointToActuatorPositionHandle,
    JointToActuatorStateHandle,
    JointToActuatorVelocityHandle,
    TransmissionHandle,
)
from station.core.hardware.transmissions.transmission_interface import (
    ActuatorToJointEffortInterface,
    ActuatorToJointPositionInterface,
    ActuatorToJointStateInterface,
    ActuatorToJointVelocityInterface,
    JointToActuatorEffortInterface,
    JointToActuatorPositionInterface,
    JointToActuatorStateInterface,
    JointToActuatorVelocityInterface,
    RobotTransmissions,
    TransmissionInterface,
)

_Interface = TypeVar("_Interface")
_Handle = TypeVar("_Handle", bound=TransmissionHandle)
Connector = Callable[
    [RobotTransmissions, str, Transmission, ActuatorData, JointData], None
]
"""Builds a handle and registers it, with its interface where that is missing."""


def interface_of(
    manager: InterfaceManager, interface_type: type[_Interface]
) -> _Interface:
    """Return an interface of a manager, a new and registered one if it has none.

    Args:
        manager: A robot or its transmissions.
        interface_type: The interface; made without arguments.

    Returns:
        The interface.
    """
    interface = manager.get(interface_type)
    if interface is None:
        interface = interface_type()
        manager.register_interface(interface)
    return interface


def _connector(
    interface_type: type[TransmissionInterface[_Handle]], handle_type: type[_Handle]
) -> Connector:
    def connect(
        transmissions: RobotTransmissions,
        name: str,
        transmission: Transmission,
        actuator: ActuatorData,
        joint: JointData,
    ) -> None:
        handle = handle_type(name, transmission, actuator, joint)
        interface_of(transmissions, interface_type).register_handle(handle)

    return connect


connect_actuator_to_joint_state = _connector(
    ActuatorToJointStateInterface, ActuatorToJointStateHandle
)
connect_joint_to_actuator_state = _connector(
    JointToActuatorStateInterface, JointToActuatorStateHandle
)


@dataclass(frozen=True, slots=True)
class CommandKind:
    """Tell what belongs to one kind of command.

    Attributes:
        quantity: "position", "velocity" or "effort".
        joint_interface: Where controllers command joints.
        actuator_interface: Where the robot offers its actuators.
        connect_to_actuator: Connects joint commands to actuator commands.
        connect_to_joint: Connects actuator commands back to joint commands.
    """

    quantity: str
    joint_interface: type[JointCommandInterface]
    actuator_interface: type[ActuatorCommandInterface]
    connect_to_actuator: Connector
    connect_to_joint: Connector


_POSITION = CommandKind(
    "position",
    PositionJointInterface,
    PositionActuatorInterface,
    _connector(JointToActuatorPositionInterface, JointToActuatorPositionHandle),
    _connector(ActuatorToJointPositionInterface, ActuatorToJointPositionHandle),
)
_VELOCITY = CommandKind(
    "velocity",
    VelocityJointInterface,
    VelocityActuatorInterface,
    _connector(JointToActuatorVelocityInterface, JointToActuatorVelocityHandle),
    _connector(ActuatorToJointVelocityInterface, ActuatorToJointVelocityHandle),
)
_EFFORT = CommandKind(
    "effort",
    EffortJointInterface,
    EffortActuatorInterface,
    _connector(JointToActuatorEffortInterface, JointToActuatorEffortHandle),
    _connector(ActuatorToJointEffortInterface, ActuatorToJointEffortHandle),
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
"""Kind of command (None: state only), and whether maps go both ways, by name."""
