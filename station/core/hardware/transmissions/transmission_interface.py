"""Connect transmissions to the values of actuators and joints, and carry them through.

Source: ros_control@633c374 transmission_interface.h, TransmissionHandle,
TransmissionInterface and those derived from them; robot_transmissions.h; differs: one
handle with a direction and quantities in place of one class for each combination; a
"pointer" is a list of floats and an index; a quantity that is missing on one side is
left out instead of being undefined; the sizes of torque sensor data are checked, too;
an unknown transmission raises `ResourceNotFoundError` as in every other interface.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, fields
from enum import Enum
from typing import ClassVar

from typing_extensions import override

from station.core.hardware.interfaces.resource_manager import (
    InterfaceManager,
    ResourceHandle,
    ResourceManager,
)
from station.core.hardware.slots import Slot
from station.core.hardware.transmissions.transmission import (
    SimpleTransmission,
    Transmission,
    TransmissionInterfaceError,
)
from station.core.hardware.transmissions.transmission_maps import (
    NO_OFFSET,
    ReducedValues,
)
from station.memory.doubles import as_doubles, doubles, indices

STATE = ("position", "velocity", "effort")
"""The quantities that both sides of a transmission have."""
SENSORS = ("absolute_position", "torque_sensor")
"""Quantities that are measured only on the actuator side."""
_EFFORTS = ("effort", "torque_sensor")
_POSITIONS = ("position", "absolute_position")


class Direction(Enum):
    """The direction in which values pass through a transmission."""

    ACTUATOR_TO_JOINT = "actuator_to_joint"
    JOINT_TO_ACTUATOR = "joint_to_actuator"


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

    def slots(self, quantity: str) -> list[Slot | None]:
        """Return the places of one quantity.

        Args:
            quantity: Name of an attribute.
        """
        found: list[Slot | None] = getattr(self, quantity)
        return found

    def set_quantity(self, quantity: str, slots: list[Slot | None]) -> None:
        """Set the places of one quantity.

        Args:
            quantity: Name of an attribute.
            slots: One place per joint or actuator.
        """
        setattr(self, quantity, slots)


class ActuatorData(TransmissionData):
    """Places of the values on the actuator side."""


class JointData(TransmissionData):
    """Places of the values on the joint side."""


class QuantityMap:
    """One quantity of a transmission in one direction: gather, map, scatter.

    Args:
        transmission: The transmission.
        direction: The direction of the values.
        quantity: The quantity, an attribute of `TransmissionData`.
        source: Memory of the values.
        target: Receives the values.

    Attributes:
        transmission: As given; likewise `direction`, `quantity`, `source`, `target`.
    """

    def __init__(
        self,
        transmission: Transmission,
        direction: Direction,
        quantity: str,
        source: list[Slot | None],
        target: list[Slot | None],
    ) -> None:
        self.transmission = transmission
        self.direction = direction
        self.quantity = quantity
        self.source: list[Slot] = [slot for slot in source if slot is not None]
        self.target: list[Slot] = [slot for slot in target if slot is not None]
        self._function: Callable[[list[float]], list[float]] = getattr(
            transmission, f"{direction.value}_{quantity}"
        )

    def carry(self) -> None:
        """Carry the values of this cycle over. Control thread."""
        values = self._function([storage[index] for storage, index in self.source])
        for number, (storage, index) in enumerate(self.target):
            storage[index] = values[number]


class TransmissionHandle(ResourceHandle):
    """Carry values from one side of a transmission to the other.

    Contract: built at start; `propagate` is called by the control thread every cycle
    and allocates only short lists of floats.

    Attributes:
        maps: The maps, one per quantity.
    """

    def __init__(
        self,
        name: str,
        transmission: Transmission | None,
        actuator_data: ActuatorData,
        joint_data: JointData,
        *,
        direction: Direction,
        quantities: Sequence[str],
    ) -> None:
        """Check that the transmission and the data fit.

        Args:
            name: Name of the transmission.
            transmission: The maps.
            actuator_data: Places of the values on the actuator side.
            joint_data: Places of the values on the joint side.
            direction: The direction of the values.
            quantities: The quantities to carry, attributes of `TransmissionData`; a
                quantity without places on one side is left out.

        Raises:
            TransmissionInterfaceError: There is no transmission or no data, the number
                of places does not fit the transmission, or a place is missing.
        """
        super().__init__(name)
        if transmission is None:
            raise TransmissionInterfaceError(
                "Unspecified transmission.",
                remedy=f"Give the transmission of handle '{name}'.",
            )
        _check_not_empty(name, actuator_data, joint_data)
        _check_sizes(name, "Actuator", actuator_data, transmission.num_actuators)
        _check_sizes(name, "Joint", joint_data, transmission.num_joints)
        _check_places(name, "Actuator", actuator_data)
        _check_places(name, "Joint", joint_data)
        source, target = (
            (actuator_data, joint_data)
            if direction is Direction.ACTUATOR_TO_JOINT
            else (joint_data, actuator_data)
        )
        self.maps = [
            QuantityMap(
                transmission,
                direction,
                quantity,
                source.slots(quantity),
                target.slots(quantity),
            )
            for quantity in quantities
            if source.slots(quantity) and target.slots(quantity)
        ]

    def propagate(self) -> None:
        """Carry the values of this cycle over. Control thread."""
        for quantity in self.maps:
            quantity.carry()


def _check_not_empty(name: str, actuator: ActuatorData, joint: JointData) -> None:
    if not any(
        data.slots(quantity) for data in (actuator, joint) for quantity in STATE
    ):
        raise TransmissionInterfaceError(
            "All data vectors are empty. Transmission instance can't do anything!.",
            remedy=f"Give handle '{name}' positions, velocities or efforts.",
        )


def _check_sizes(name: str, side: str, data: TransmissionData, size: int) -> None:
    for quantity, slots in _quantities(data):
        if slots and len(slots) != size:
            raise TransmissionInterfaceError(
                f"{side} {quantity} data size does not match transmission.",
                remedy=f"Give handle '{name}' {size} places, not {len(slots)}.",
            )


def _check_places(name: str, side: str, data: TransmissionData) -> None:
    for quantity, slots in _quantities(data):
        if None in slots:
            raise TransmissionInterfaceError(
                f"{side} {quantity} data contains null pointers.",
                remedy=f"Give handle '{name}' a list and an index for every place.",
            )


def _quantities(data: TransmissionData) -> list[tuple[str, list[Slot | None]]]:
    """Return the name in messages and the places of every quantity."""
    names = [attribute.name for attribute in fields(data)]
    return [(name.replace("_", " "), data.slots(name)) for name in names]


class Propagation:
    """Carries the values of some transmissions over, once per cycle. Control thread.

    Simple transmissions whose values are in the same doubles are handled together, the
    others one after the other, with the same result.

    Args:
        handles: The transmissions. No two of them have the same target.
    """

    def __init__(self, handles: Iterable[TransmissionHandle] = ()) -> None:
        self._steps: list[Callable[[], None]] = []
        alike: dict[tuple[object, ...], list[QuantityMap]] = {}
        for handle in handles:
            for one in handle.maps:
                if _is_simple(one):
                    source, target = one.source[0][0], one.target[0][0]
                    key = (one.direction, one.quantity, id(source), id(target))
                    alike.setdefault(key, []).append(one)
                else:
                    self._steps.append(one.carry)
        self._steps += [_together(maps).carry for maps in alike.values()]

    def carry(self) -> None:
        """Carry the values of this cycle over."""
        for step in self._steps:
            step()


def _is_simple(one: QuantityMap) -> bool:
    # A derived class may have its own maps.
    return type(one.transmission) is SimpleTransmission and all(
        isinstance(slots[0][0], memoryview) for slots in (one.source, one.target)
    )


def _together(maps: Sequence[QuantityMap]) -> ReducedValues:
    """Return one object that carries a quantity over several simple transmissions."""
    reductions = [
        one.transmission
        for one in maps
        if isinstance(one.transmission, SimpleTransmission)
    ]
    first = maps[0]
    to_joints = first.direction is Direction.ACTUATOR_TO_JOINT
    multiplies = (first.quantity in _EFFORTS) is to_joints
    offsets = [0.0 if multiplies else NO_OFFSET] * len(maps)
    if first.quantity in _POSITIONS:
        offsets = [one.joint_offset for one in reductions]
    return ReducedValues(
        as_doubles(first.source[0][0]),
        as_doubles(first.target[0][0]),
        source_places=indices([one.source[0][1] for one in maps]),
        target_places=indices([one.target[0][1] for one in maps]),
        reductions=doubles([one.reduction for one in reductions]),
        offsets=doubles(offsets),
        multiplies=multiplies,
    )


class RobotTransmissions(InterfaceManager):
    """Hold one transmission interface of each kind that the robot needs."""


class TransmissionInterface(ResourceManager[TransmissionHandle]):
    """Hold the handles of one direction and some quantities, filled at start.

    Attributes:
        direction: Direction of the values in every transmission.
        quantities: The quantities that are carried.
    """

    direction: ClassVar[Direction]
    quantities: ClassVar[tuple[str, ...]]

    def __init__(self) -> None:
        super().__init__()
        self._propagation = Propagation()

    @override
    def __init_subclass__(cls) -> None:
        """Name the interface as ros_control does."""
        super().__init_subclass__()
        cls.type_name = f"transmission_interface::{cls.__name__}"

    @override
    def register_handle(self, handle: TransmissionHandle) -> None:
        super().register_handle(handle)
        self._propagation = Propagation(self.handles())

    def connect(
        self,
        name: str,
        transmission: Transmission | None,
        actuator_data: ActuatorData,
        joint_data: JointData,
    ) -> None:
        """Register a handle that carries this interface's quantities.

        Args:
            name: Name of the transmission.
            transmission: The maps.
            actuator_data: Places on the actuator side.
            joint_data: Places on the joint side.

        Raises:
            TransmissionInterfaceError: The transmission and the data do not fit; see
                `TransmissionHandle`.
        """
        self.register_handle(
            TransmissionHandle(
                name,
                transmission,
                actuator_data,
                joint_data,
                direction=self.direction,
                quantities=self.quantities,
            )
        )

    def propagate(self) -> None:
        """Carry the values of this cycle through all transmissions. Control thread."""
        self._propagation.carry()


class ActuatorToJointStateInterface(TransmissionInterface):
    """Carry actuator state, encoders and torque sensors to the joints."""

    direction = Direction.ACTUATOR_TO_JOINT
    quantities = STATE + SENSORS


class ActuatorToJointPositionInterface(TransmissionInterface):
    """Carry actuator positions to the joints."""

    direction = Direction.ACTUATOR_TO_JOINT
    quantities = ("position",)


class ActuatorToJointVelocityInterface(TransmissionInterface):
    """Carry actuator velocities to the joints."""

    direction = Direction.ACTUATOR_TO_JOINT
    quantities = ("velocity",)


class ActuatorToJointEffortInterface(TransmissionInterface):
    """Carry actuator efforts to the joints."""

    direction = Direction.ACTUATOR_TO_JOINT
    quantities = ("effort",)


class JointToActuatorStateInterface(TransmissionInterface):
    """Carry joint state to the actuators."""

    direction = Direction.JOINT_TO_ACTUATOR
    quantities = STATE


class JointToActuatorPositionInterface(TransmissionInterface):
    """Carry joint positions to the actuators."""

    direction = Direction.JOINT_TO_ACTUATOR
    quantities = ("position",)


class JointToActuatorVelocityInterface(TransmissionInterface):
    """Carry joint velocities to the actuators."""

    direction = Direction.JOINT_TO_ACTUATOR
    quantities = ("velocity",)


class JointToActuatorEffortInterface(TransmissionInterface):
    """Carry joint efforts to the actuators."""

    direction = Direction.JOINT_TO_ACTUATOR
    quantities = ("effort",)
