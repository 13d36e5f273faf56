"""Carry values through all transmissions of a robot in one call.

Source: ros_control@633c374 transmission_interface.h, TransmissionInterface and the
interfaces derived from it; robot_transmissions.h; differs: an unknown transmission
raises `ResourceNotFoundError` as in every other interface.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import ClassVar

from typing_extensions import override

from station.core.hardware.interfaces.interface_manager import InterfaceManager
from station.core.hardware.interfaces.resource_manager import ResourceManager
from station.core.hardware.transmissions.transmission import (
    SimpleTransmission,
    Transmission,
)
from station.core.hardware.transmissions.transmission_handle import (
    SENSORS,
    STATE,
    ActuatorData,
    Direction,
    JointData,
    QuantityMap,
    TransmissionHandle,
)
from station.core.hardware.transmissions.transmission_maps import (
    NO_OFFSET,
    ReducedValues,
)
from station.memory.doubles import as_doubles, doubles, indices

_EFFORTS = ("effort", "torque_sensor")
_POSITIONS = ("position", "absolute_position")


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
