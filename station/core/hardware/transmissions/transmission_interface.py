"""Carry values through all transmissions of a robot in one call.

Source: ros_control@633c374 transmission_interface.h, TransmissionInterface and the
interfaces derived from it; robot_transmissions.h; differs: an unknown transmission
raises `ResourceNotFoundError` as in every other interface.
"""

from typing import ClassVar, TypeVar

from typing_extensions import override

from station.core.hardware.interfaces.interface_manager import InterfaceManager
from station.core.hardware.interfaces.resource_manager import ResourceManager
from station.core.hardware.transmissions.transmission_handle import (
    ActuatorToJointEffortHandle,
    ActuatorToJointPositionHandle,
    ActuatorToJointStateHandle,
    ActuatorToJointVelocityHandle,
    JointToActuatorEffortHandle,
    JointToActuatorPositionHandle,
    JointToActuatorStateHandle,
    JointToActuatorVelocityHandle,
    TransmissionHandle,
)

T = TypeVar("T", bound=TransmissionHandle)


class RobotTransmissions(InterfaceManager):
    """Hold one transmission interface of each kind that the robot needs."""


class TransmissionInterface(ResourceManager[T]):
    """Hold the handles of one kind, filled at start."""

    type_name: ClassVar[str] = "transmission_interface::TransmissionInterface"

    def __init__(self) -> None:
        super().__init__()
        self._propagated: list[T] = []

    @override
    def register_handle(self, handle: T) -> None:
        super().register_handle(handle)
        self._propagated = self.handles()

    def propagate(self) -> None:
        """Carry the values of this cycle through all transmissions. Control thread."""
        for handle in self._propagated:
            handle.propagate()


class ActuatorToJointStateInterface(TransmissionInterface[ActuatorToJointStateHandle]):
    """Carry actuator state to the joints."""

    type_name: ClassVar[str] = "transmission_interface::ActuatorToJointStateInterface"


class ActuatorToJointPositionInterface(
    TransmissionInterface[ActuatorToJointPositionHandle]
):
    """Carry actuator positions to the joints."""

    type_name: ClassVar[str] = (
        "transmission_interface::ActuatorToJointPositionInterface"
    )


class ActuatorToJointVelocityInterface(
    TransmissionInterface[ActuatorToJointVelocityHandle]
):
    """Carry actuator velocities to the joints."""

    type_name: ClassVar[str] = (
        "transmission_interface::ActuatorToJointVelocityInterface"
    )


class ActuatorToJointEffortInterface(
    TransmissionInterface[ActuatorToJointEffortHandle]
):
    """Carry actuator efforts to the joints."""

    type_name: ClassVar[str] = "transmission_interface::ActuatorToJointEffortInterface"


class JointToActuatorStateInterface(TransmissionInterface[JointToActuatorStateHandle]):
    """Carry joint state to the actuators."""

    type_name: ClassVar[str] = "transmission_interface::JointToActuatorStateInterface"


class JointToActuatorPositionInterface(
    TransmissionInterface[JointToActuatorPositionHandle]
):
    """Carry joint positions to the actuators."""

    type_name: ClassVar[str] = (
        "transmission_interface::JointToActuatorPositionInterface"
    )


class JointToActuatorVelocityInterface(
    TransmissionInterface[JointToActuatorVelocityHandle]
):
    """Carry joint velocities to the actuators."""

    type_name: ClassVar[str] = (
        "transmission_interface::JointToActuatorVelocityInterface"
    )


class JointToActuatorEffortInterface(
    TransmissionInterface[JointToActuatorEffortHandle]
):
    """Carry joint efforts to the actuators."""

    type_name: ClassVar[str] = "transmission_interface::JointToActuatorEffortInterface"
