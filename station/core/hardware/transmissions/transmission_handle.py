"""Connect a transmission to the places where actuator and joint values are kept.

Source: ros_control@633c374 transmission_interface.h, TransmissionHandle and the handles
derived from it; differs: a "pointer" is a list of floats and an index, a quantity that
is missing on one side is left out instead of being undefined, and the sizes of torque
sensor data are checked too.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field

from typing_extensions import override

from station.core.hardware.interfaces.resource_manager import ResourceHandle
from station.core.hardware.transmissions.transmission import (
    Transmission,
    TransmissionInterfaceError,
)

Slot = tuple[list[float], int]
"""A place for one value: the list that holds it, and the index in that list."""


@dataclass(slots=True)
class TransmissionData:
    """Places of the values on one side of a transmission, in the transmission's order.

    An empty list means that the quantity is not used. The owner of the lists must
    change them in place.

    Attributes:
        position: Positions [rad or m].
        velocity: Velocities [rad/s or m/s].
        effort: Efforts [N*m or N].
        absolute_position: Readings of absolute encoders [rad or m].
        torque_sensor: Readings of torque sensors [N*m or N].
    """

    position: list[Slot | None] = field(default_factory=list)
    velocity: list[Slot | None] = field(default_factory=list)
    effort: list[Slot | None] = field(default_factory=list)
    absolute_position: list[Slot | None] = field(default_factory=list)
    torque_sensor: list[Slot | None] = field(default_factory=list)

    def set_quantity(self, quantity: str, slots: list[Slot | None]) -> None:
        """Set the places of one quantity.

        Args:
            quantity: "position", "velocity" or "effort".
            slots: One place per joint or actuator.
        """
        if quantity == "position":
            self.position = slots
        elif quantity == "velocity":
            self.velocity = slots
        else:
            self.effort = slots

    def quantities(self) -> list[tuple[str, list[Slot | None]]]:
        """Return the name in messages and the places of every quantity."""
        return [
            ("position", self.position),
            ("velocity", self.velocity),
            ("effort", self.effort),
            ("absolute position", self.absolute_position),
            ("torque sensor", self.torque_sensor),
        ]


class ActuatorData(TransmissionData):
    """Places of the values on the actuator side."""


class JointData(TransmissionData):
    """Places of the values on the joint side."""


class _Map:
    """One quantity in one direction: gather, map, scatter."""

    def __init__(
        self,
        function: Callable[[list[float]], list[float]],
        source: list[Slot | None],
        target: list[Slot | None],
    ) -> None:
        self._function = function
        self._source: list[Slot] = [slot for slot in source if slot is not None]
        self._target: list[Slot] = [slot for slot in target if slot is not None]

    def run(self) -> None:
        values = self._function([storage[index] for storage, index in self._source])
        for number, (storage, index) in enumerate(self._target):
            storage[index] = values[number]


class TransmissionHandle(ResourceHandle, ABC):
    """Carry values from one side of a transmission to the other.

    Contract: built at start; `propagate` is called by the control thread every cycle
    and allocates only short lists of floats.
    """

    def __init__(
        self,
        name: str,
        transmission: Transmission | None,
        actuator_data: ActuatorData,
        joint_data: JointData,
    ) -> None:
        """Check that the transmission and the data fit.

        Args:
            name: Name of the transmission.
            transmission: The maps.
            actuator_data: Places on the actuator side.
            joint_data: Places on the joint side.

        Raises:
            TransmissionInterfaceError: There is no transmission, no data at all, a
                number of places that is not the transmission's, or a place is missing.
        """
        super().__init__(name)
        if transmission is None:
            raise TransmissionInterfaceError(
                "Unspecified transmission.",
                remedy=f"Give the transmission of handle '{name}'.",
            )
        self.transmission: Transmission = transmission
        self.actuator_data: ActuatorData = actuator_data
        self.joint_data: JointData = joint_data
        self._maps: list[_Map] = []
        _check_not_empty(name, actuator_data, joint_data)
        _check_sizes(name, "Actuator", actuator_data, transmission.num_actuators)
        _check_sizes(name, "Joint", joint_data, transmission.num_joints)
        _check_places(name, "Actuator", actuator_data)
        _check_places(name, "Joint", joint_data)
        self._connect(transmission, actuator_data, joint_data)

    def propagate(self) -> None:
        """Carry the values of this cycle over. Control thread."""
        for quantity in self._maps:
            quantity.run()

    @abstractmethod
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        """Add the maps that this kind of handle carries out."""

    def _add_map(
        self,
        function: Callable[[list[float]], list[float]],
        source: list[Slot | None],
        target: list[Slot | None],
    ) -> None:
        if source and target:
            self._maps.append(_Map(function, source, target))


class ActuatorToJointStateHandle(TransmissionHandle):
    """Carry actuator state, encoders and torque sensors to the joints."""

    @override
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        self._add_map(
            maps.actuator_to_joint_position, actuator.position, joint.position
        )
        self._add_map(
            maps.actuator_to_joint_velocity, actuator.velocity, joint.velocity
        )
        self._add_map(maps.actuator_to_joint_effort, actuator.effort, joint.effort)
        self._add_map(
            maps.actuator_to_joint_absolute_position,
            actuator.absolute_position,
            joint.absolute_position,
        )
        self._add_map(
            maps.actuator_to_joint_torque_sensor,
            actuator.torque_sensor,
            joint.torque_sensor,
        )


class ActuatorToJointPositionHandle(TransmissionHandle):
    """Carry actuator positions to joint positions."""

    @override
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        self._add_map(
            maps.actuator_to_joint_position, actuator.position, joint.position
        )


class ActuatorToJointVelocityHandle(TransmissionHandle):
    """Carry actuator velocities to joint velocities."""

    @override
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        self._add_map(
            maps.actuator_to_joint_velocity, actuator.velocity, joint.velocity
        )


class ActuatorToJointEffortHandle(TransmissionHandle):
    """Carry actuator efforts to joint efforts."""

    @override
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        self._add_map(maps.actuator_to_joint_effort, actuator.effort, joint.effort)


class JointToActuatorStateHandle(TransmissionHandle):
    """Carry joint state to the actuators."""

    @override
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        self._add_map(
            maps.joint_to_actuator_position, joint.position, actuator.position
        )
        self._add_map(
            maps.joint_to_actuator_velocity, joint.velocity, actuator.velocity
        )
        self._add_map(maps.joint_to_actuator_effort, joint.effort, actuator.effort)


class JointToActuatorPositionHandle(TransmissionHandle):
    """Carry joint positions to actuator positions."""

    @override
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        self._add_map(
            maps.joint_to_actuator_position, joint.position, actuator.position
        )


class JointToActuatorVelocityHandle(TransmissionHandle):
    """Carry joint velocities to actuator velocities."""

    @override
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        self._add_map(
            maps.joint_to_actuator_velocity, joint.velocity, actuator.velocity
        )


class JointToActuatorEffortHandle(TransmissionHandle):
    """Carry joint efforts to actuator efforts."""

    @override
    def _connect(
        self, maps: Transmission, actuator: ActuatorData, joint: JointData
    ) -> None:
        self._add_map(maps.joint_to_actuator_effort, joint.effort, actuator.effort)


def _check_not_empty(name: str, actuator: ActuatorData, joint: JointData) -> None:
    main = (actuator.position, actuator.velocity, actuator.effort)
    if not any((*main, joint.position, joint.velocity, joint.effort)):
        raise TransmissionInterfaceError(
            "All data vectors are empty. Transmission instance can't do anything!.",
            remedy=f"Give handle '{name}' positions, velocities or efforts.",
        )


def _check_sizes(name: str, side: str, data: TransmissionData, size: int) -> None:
    for quantity, slots in data.quantities():
        if slots and len(slots) != size:
            raise TransmissionInterfaceError(
                f"{side} {quantity} data size does not match transmission.",
                remedy=f"Give handle '{name}' {size} places, not {len(slots)}.",
            )


def _check_places(name: str, side: str, data: TransmissionData) -> None:
    for quantity, slots in data.quantities():
        if None in slots:
            raise TransmissionInterfaceError(
                f"{side} {quantity} data contains null pointers.",
                remedy=f"Give handle '{name}' a list and an index for every place.",
            )
