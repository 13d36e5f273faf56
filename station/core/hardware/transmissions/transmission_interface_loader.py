"""Connect joints and actuators of a robot by transmissions, and offer the joints.

Source: ros_control@633c374 transmission_interface_loader.cpp and the providers of joint
interfaces beside it, which transmission_interface/ros_control_plugins.xml lists;
differs: failures raise, and a joint has an absolute position and a torque sensor only
if all actuators of its transmission have one.

As in the original, roles determine the order of a transmission's parameters, but its
joints and actuators stay in the order of the document. They must therefore be listed in
the order of their roles.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import TypeVar

from station.core.errors import HardwareInterfaceError, ResourceNotFoundError
from station.core.hardware.interfaces.joint import (
    ActuatorCommandInterface,
    ActuatorHandle,
    ActuatorStateHandle,
    ActuatorStateInterface,
    EffortActuatorInterface,
    EffortJointInterface,
    JointCommandInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionActuatorInterface,
    PositionJointInterface,
    VelocityActuatorInterface,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.resource_manager import (
    InterfaceManager,
    ResourceHandle,
    ResourceManager,
)
from station.core.hardware.slots import Slot
from station.core.hardware.transmissions.transmission import (
    Transmission,
    TransmissionInterfaceError,
)
from station.core.hardware.transmissions.transmission_interface import (
    SENSORS,
    STATE,
    ActuatorData,
    ActuatorToJointEffortInterface,
    ActuatorToJointPositionInterface,
    ActuatorToJointStateInterface,
    ActuatorToJointVelocityInterface,
    JointData,
    JointToActuatorEffortInterface,
    JointToActuatorPositionInterface,
    JointToActuatorStateInterface,
    JointToActuatorVelocityInterface,
    RobotTransmissions,
    TransmissionInterface,
)
from station.core.hardware.transmissions.transmission_loader import (
    TransmissionFactory,
    TransmissionInfo,
    TransmissionParser,
    load_transmission,
)
from station.memory.doubles import Storage, doubles

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


class RawJointData:
    """Hold state and commands of joints, one slot per joint.

    If the joints are named at the start, their values lie side by side in doubles.
    Otherwise the values are lists, which grow with the joints.

    All values are NaN until they are first written: states by the transmissions in the
    robot's first `read`, commands by the robot when it starts and by controllers.

    Args:
        joints: Names of all joints that will be added; None if they are not known yet.

    Attributes:
        names: Joint names, in the order of the slots.
        position: Positions [rad or m], shape (n,).
        velocity: Velocities [rad/s or m/s], shape (n,).
        effort: Efforts [N*m or N], shape (n,).
        absolute_position: Absolute encoders, joint side [rad or m], shape (n,).
        torque_sensor: Torque sensors, joint side [N*m or N], shape (n,).
        position_command: Position commands [rad or m], shape (n,).
        velocity_command: Velocity commands [rad/s or m/s], shape (n,).
        effort_command: Effort commands [N*m or N], shape (n,).

    Source:
        ros_control@633c374 transmission_interface_loader.h, RawJointData; differs: one
        list per quantity, not one object per joint.
    """

    def __init__(self, joints: Sequence[str] | None = None) -> None:
        self.names: list[str] = list(joints or [])
        self._is_known = joints is not None
        self._states = {quantity: self._new_values() for quantity in STATE + SENSORS}
        self._commands = {quantity: self._new_values() for quantity in STATE}
        self.position, self.velocity, self.effort, *sensors = self._states.values()
        self.absolute_position, self.torque_sensor = sensors
        commands = self._commands.values()
        self.position_command, self.velocity_command, self.effort_command = commands

    def _new_values(self) -> Storage:
        return doubles([nan] * len(self.names)) if self._is_known else []

    def add(self, name: str) -> int:
        """Return the slot of a joint; make one for a joint that has none.

        Args:
            name: Name of the joint.

        Returns:
            The index in all values.

        Raises:
            HardwareInterfaceError: Joints were named at the start, but not this one.
        """
        if name in self.names:
            return self.names.index(name)
        for values in (*self._states.values(), *self._commands.values()):
            if not isinstance(values, list):
                raise HardwareInterfaceError(
                    f"Joint '{name}' was not named when the storage was made.",
                    remedy=f"Choose among {', '.join(self.names) or 'none'}.",
                )
            values.append(nan)
        self.names.append(name)
        return len(self.names) - 1

    def state_data(self, names: list[str]) -> JointData:
        """Return the places of the states of some joints.

        Args:
            names: Joints that have a slot, in the order of a transmission.

        Returns:
            The places, in the same order.
        """
        data = JointData()
        for quantity, values in self._states.items():
            data.set_quantity(quantity, self._slots(values, names))
        return data

    def command_data(self, names: list[str], quantity: str) -> JointData:
        """Return the places of one kind of command of some joints.

        Args:
            names: Joints that have a slot, in the order of a transmission.
            quantity: "position", "velocity" or "effort".

        Returns:
            The places, in the same order, under that quantity.
        """
        data = JointData()
        data.set_quantity(quantity, self._slots(self.commands(quantity), names))
        return data

    def commands(self, quantity: str) -> Storage:
        """Return the storage that holds one kind of command.

        Args:
            quantity: "position", "velocity" or "effort".

        Returns:
            The storage itself, one slot per joint.
        """
        return self._commands[quantity]

    def _slots(self, values: Storage, names: list[str]) -> list[Slot | None]:
        return [(values, self.names.index(name)) for name in names]


_Handle = TypeVar("_Handle", bound=ResourceHandle)


@dataclass(frozen=True, slots=True)
class LoadedTransmission:
    """A transmission that was connected through a joint interface.

    Attributes:
        info: The description of the transmission.
        hardware_interface: Name of the joint interface in the description.
        transmission: The maps.
    """

    info: TransmissionInfo
    hardware_interface: str
    transmission: Transmission


class TransmissionInterfaceLoader:
    """Connects joint interfaces to actuators by transmissions.

    A robot uses the loader in `init`, after it has registered its actuator interfaces.
    The loader registers missing joint interfaces on the robot and missing transmission
    interfaces on its `RobotTransmissions`. Afterwards the robot propagates the actuator
    state to the joints in `read`, and the active commands to the actuators in `write`.

    Attributes:
        raw_joint_data: State and commands of all loaded joints.
        loaded: One entry per transmission and joint interface, in the order of loading.
        problems: One sentence for each part that was skipped while the rest was loaded.
    """

    def __init__(
        self,
        robot_hw: InterfaceManager,
        robot_transmissions: RobotTransmissions,
        transmission_types: Mapping[str, TransmissionFactory] | None = None,
        joints: Sequence[str] | None = None,
    ) -> None:
        """Create a loader that has loaded nothing yet.

        Args:
            robot_hw: The robot that has the actuators and gets the joints.
            robot_transmissions: The manager that receives the transmission interfaces.
            transmission_types: Further types of transmissions, by the name in `<type>`.
            joints: Names of all joints that will be loaded, if they are known; their
                values then lie side by side in doubles.
        """
        self._robot_hw = robot_hw
        self._robot_transmissions = robot_transmissions
        self._transmission_types = transmission_types
        self.raw_joint_data = RawJointData(joints)
        self._joints: set[str] = set()
        self.loaded: list[LoadedTransmission] = []
        self.problems: list[str] = []

    def load_urdf(self, urdf: str) -> None:
        """Load all transmissions of a robot description that can be read.

        Args:
            urdf: The robot description.

        Raises:
            RobotDescriptionError: The description is not XML.
            TransmissionInterfaceError: The description has no readable transmission, or
                one that cannot be loaded; transmissions before it stay loaded.
        """
        parser = TransmissionParser()
        infos = parser.parse(urdf)
        self.problems.extend(parser.problems)
        if not infos:
            reasons = " ".join(parser.problems)
            raise TransmissionInterfaceError(
                f"No transmissions were found in the robot description. {reasons}",
                remedy="Give the robot description <transmission> elements.",
            )
        for info in infos:
            self.load(info)

    def load(self, info: TransmissionInfo) -> None:
        """Load a transmission for all joint interfaces that its description names.

        Args:
            info: The description of the transmission.

        Raises:
            TransmissionInterfaceError: The type or a parameter is wrong, the joints
                name different interfaces, or none of the interfaces can be connected.
        """
        transmission = load_transmission(info, self._transmission_types)
        interfaces = info.joints[0].hardware_interfaces
        for joint in info.joints:
            if sorted(joint.hardware_interfaces) != sorted(interfaces):
                raise TransmissionInterfaceError(
                    f"Failed to load transmission '{info.name}'. It has joints with "
                    "different hardware interfaces. This is currently unsupported.",
                    remedy="Give all its joints the same <hardwareInterface> elements.",
                    details={"transmission": info.name},
                )
        problems = []
        for name in interfaces:
            try:
                self._load_for_interface(name, info, transmission)
            except HardwareInterfaceError as exc:
                problems.append(exc.message)
            else:
                self.loaded.append(LoadedTransmission(info, name, transmission))
        # As upstream, one usable interface is enough; the others are reported.
        if len(problems) == len(interfaces):
            raise TransmissionInterfaceError(
                f"Failed to load transmission '{info.name}'. "
                f"It contains no valid hardware interfaces. {' '.join(problems)}",
                remedy="Correct its <hardwareInterface> elements or its actuators.",
                details={"transmission": info.name},
            )
        self.problems.extend(problems)

    def _load_for_interface(
        self, name: str, info: TransmissionInfo, transmission: Transmission
    ) -> None:
        if name not in HARDWARE_INTERFACES:
            raise TransmissionInterfaceError(
                f"Failed to process the '{name}' hardware interface for transmission "
                f"'{info.name}'. Known are {', '.join(HARDWARE_INTERFACES)}.",
                remedy="Use one of the known interfaces.",
            )
        kind, is_bidirectional = HARDWARE_INTERFACES[name]
        states = self._find_actuators(info, ActuatorStateInterface)
        commands: list[ActuatorHandle] = []
        if kind is not None:
            commands = self._find_actuators(info, kind.actuator_interface)
        self._register_joint_states(info, states)
        self._connect_states(info, transmission, states, both_ways=is_bidirectional)
        if kind is None:
            return
        self._register_joint_commands(info, kind)
        actuator = _actuator_command_data(commands, kind.quantity)
        joint = self.raw_joint_data.command_data(_joint_names(info), kind.quantity)
        for interface_type, is_used in (
            (kind.to_actuator, True),
            (kind.to_joint, is_bidirectional),
        ):
            if is_used:
                interface = interface_of(self._robot_transmissions, interface_type)
                interface.connect(info.name, transmission, actuator, joint)

    def _find_actuators(
        self, info: TransmissionInfo, interface_type: type[ResourceManager[_Handle]]
    ) -> list[_Handle]:
        type_name = interface_type.type_name
        interface = self._robot_hw.get(interface_type)
        if interface is None:
            raise TransmissionInterfaceError(
                f"Robot does not have the required hardware interface '{type_name}'.",
                remedy="Register it on the robot before the transmissions are loaded.",
            )
        handles = []
        for actuator in info.actuators:
            try:
                handles.append(interface.get_handle(actuator.name))
            except ResourceNotFoundError as exc:
                raise TransmissionInterfaceError(
                    f"Actuator '{actuator.name}' does not expose the required hardware "
                    f"interface '{type_name}'.",
                    remedy=exc.remedy,
                ) from exc
        return handles

    def _register_joint_states(
        self, info: TransmissionInfo, actuators: list[ActuatorStateHandle]
    ) -> None:
        interface = interface_of(self._robot_hw, JointStateInterface)
        raw = self.raw_joint_data
        registered = interface.get_names()
        for name in _joint_names(info):
            if name in registered and name not in self._joints:
                raise TransmissionInterfaceError(
                    f"Joint '{name}' of transmission '{info.name}' already has a state "
                    "that does not come from a transmission.",
                    remedy="Leave the joint to the transmission, or the transmission "
                    "out of the robot description.",
                )
        has_encoders = all(a.has_absolute_position() for a in actuators)
        has_torque_sensors = all(a.has_torque_sensor() for a in actuators)
        for name in _joint_names(info):
            if name in registered:
                continue
            index = raw.add(name)
            self._joints.add(name)
            handle = JointStateHandle(
                name,
                raw.position,
                raw.velocity,
                raw.effort,
                index,
                absolute_position=raw.absolute_position if has_encoders else None,
                torque_sensor=raw.torque_sensor if has_torque_sensors else None,
            )
            interface.register_handle(handle)

    def _register_joint_commands(
        self, info: TransmissionInfo, kind: CommandKind
    ) -> None:
        interface = interface_of(self._robot_hw, kind.joint_interface)
        states = interface_of(self._robot_hw, JointStateInterface)
        registered = interface.get_names()
        commands = self.raw_joint_data.commands(kind.quantity)
        for name in _joint_names(info):
            if name not in registered:
                index = self.raw_joint_data.add(name)
                handle = JointHandle(states.get_handle(name), commands, index)
                interface.register_handle(handle)

    def _connect_states(
        self,
        info: TransmissionInfo,
        transmission: Transmission,
        actuators: list[ActuatorStateHandle],
        *,
        both_ways: bool,
    ) -> None:
        actuator = _actuator_state_data(actuators)
        joint = self.raw_joint_data.state_data(_joint_names(info))
        for interface_type, is_used in (
            (ActuatorToJointStateInterface, True),
            (JointToActuatorStateInterface, both_ways),
        ):
            if not is_used:
                continue
            interface = interface_of(self._robot_transmissions, interface_type)
            # A transmission with several joint interfaces carries its state only once.
            if info.name not in interface.get_names():
                interface.connect(info.name, transmission, actuator, joint)


def _joint_names(info: TransmissionInfo) -> list[str]:
    return [joint.name for joint in info.joints]


def _actuator_state_data(handles: list[ActuatorStateHandle]) -> ActuatorData:
    data = ActuatorData()
    for quantity in STATE + SENSORS:
        storages = [getattr(handle, f"{quantity}_storage") for handle in handles]
        # A sensor counts only if every actuator has it.
        if all(storage is not None for storage in storages):
            places = [handle.index for handle in handles]
            data.set_quantity(quantity, [*zip(storages, places, strict=True)])
    return data


def _actuator_command_data(
    handles: list[ActuatorHandle], quantity: str
) -> ActuatorData:
    slots: list[Slot | None] = [(h.command_storage, h.command_index) for h in handles]
    data = ActuatorData()
    data.set_quantity(quantity, slots)
    return data
