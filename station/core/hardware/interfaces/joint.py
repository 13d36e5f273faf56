"""Handles and interfaces of joints and actuators: state, commands and modes.

Source: ros_control@0.20.0 hardware_interface/joint_state_interface.h,
joint_command_interface.h; differs: a "pointer" is a list of floats and an index, so
that a group of joints can be read and written in one operation (`joint_group.py`).
"""

from enum import IntEnum
from typing import ClassVar

from typing_extensions import override

from station.core.errors import HardwareInterfaceError, refuse_non_number
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
    check_storage,
)
from station.memory.doubles import Storage

POSITION_START_JUMP = 0.01
"""Largest distance of a first position command from rest [rad or m]."""
VELOCITY_START_JUMP = 0.05
"""Largest distance of a first velocity command from rest [rad/s or m/s]."""
EFFORT_START_JUMP = 5.0
"""Largest distance of a first effort command from rest [Nm or N]."""


class JointStateHandle(ResourceHandle):
    """Reads the state of one joint.

    Args:
        name: Name of the joint.
        position: The robot's positions [rad or m]; slot `index` is this joint's.
        velocity: The robot's velocities [rad/s or m/s].
        effort: The robot's efforts [Nm or N].
        index: The joint's slot in all these lists.
        absolute_position: Absolute encoder positions [rad or m]; None if there is none.
        torque_sensor: Joint torque sensors [Nm or N]; None if there is none.

    The robot must change the lists in place and never bind new ones.

    Raises:
        HardwareInterfaceError: A list is None or has no slot `index`.
    """

    def __init__(
        self,
        name: str,
        position: Storage | None,
        velocity: Storage | None,
        effort: Storage | None,
        index: int = 0,
        *,
        absolute_position: Storage | None = None,
        torque_sensor: Storage | None = None,
    ) -> None:
        super().__init__(name)
        self.index = index
        self.position_storage = check_storage(name, "Position", position, index)
        self.velocity_storage = check_storage(name, "Velocity", velocity, index)
        self.effort_storage = check_storage(name, "Effort", effort, index)
        self.absolute_position_storage = absolute_position
        self.torque_sensor_storage = torque_sensor
        if absolute_position is not None:
            check_storage(name, "Absolute position", absolute_position, index)
        if torque_sensor is not None:
            check_storage(name, "Torque sensor", torque_sensor, index)

    def get_position(self) -> float:
        """Return the position [rad or m]."""
        return self.position_storage[self.index]

    def get_velocity(self) -> float:
        """Return the velocity [rad/s or m/s]."""
        return self.velocity_storage[self.index]

    def get_effort(self) -> float:
        """Return the effort [Nm or N]."""
        return self.effort_storage[self.index]

    def has_absolute_position(self) -> bool:
        """Return whether the joint has an absolute encoder."""
        return self.absolute_position_storage is not None

    def has_torque_sensor(self) -> bool:
        """Return whether the joint has a torque sensor."""
        return self.torque_sensor_storage is not None

    def get_absolute_position(self) -> float:
        """Return the absolute encoder's position [rad or m].

        Raises:
            HardwareInterfaceError: The joint has no absolute encoder.
        """
        if self.absolute_position_storage is None:
            raise self._missing("absolute encoder", "has_absolute_position")
        return self.absolute_position_storage[self.index]

    def get_torque_sensor(self) -> float:
        """Return the torque sensor's reading [Nm or N].

        Raises:
            HardwareInterfaceError: The joint has no torque sensor.
        """
        if self.torque_sensor_storage is None:
            raise self._missing("torque sensor", "has_torque_sensor")
        return self.torque_sensor_storage[self.index]

    def _missing(self, sensor: str, question: str) -> HardwareInterfaceError:
        return HardwareInterfaceError(
            f"Joint '{self.name}' has no {sensor}.",
            remedy=f"Ask {question}() first.",
            details={"resource": self.name},
        )


class CommandedJointHandle(JointStateHandle):
    """The state of a joint and its slot for commands, for handles that command it.

    Args:
        state: State handle of the joint.
        index: The joint's slot in the lists of commands; None takes the slot of
            `state`.

    Attributes:
        command_index: The joint's slot in the lists of commands.
    """

    def __init__(self, state: JointStateHandle, index: int | None = None) -> None:
        super().__init__(
            state.name,
            state.position_storage,
            state.velocity_storage,
            state.effort_storage,
            state.index,
            absolute_position=state.absolute_position_storage,
            torque_sensor=state.torque_sensor_storage,
        )
        self.command_index: int = state.index if index is None else index

    def store_command(self, storage: Storage, command: float) -> None:
        """Write a command into the joint's slot.

        Args:
            storage: The robot's commands of its kind.
            command: The command.

        Raises:
            InvalidCommandError: The command is not a number. Only doubles refuse it
                here: a list stores any object, which is refused before `write`.
        """
        try:
            storage[self.command_index] = command
        # Doubles refuse other objects themselves: a check would slow every command.
        except TypeError:
            refuse_non_number(self.name, command)


class JointHandle(CommandedJointHandle):
    """Reads the state of one joint and commands it with one value.

    Args:
        state: State handle of the joint.
        command: The robot's commands of one kind.
        index: The joint's slot in `command`; None takes the slot of `state`.

    Raises:
        HardwareInterfaceError: `command` is None or has no slot `index`.
    """

    def __init__(
        self,
        state: JointStateHandle,
        command: Storage | None,
        index: int | None = None,
    ) -> None:
        super().__init__(state, index)
        self.command_storage = check_storage(
            state.name, "Command", command, self.command_index
        )

    def get_command(self) -> float:
        """Return the value commanded last."""
        return self.command_storage[self.command_index]

    def set_command(self, command: float) -> None:
        """Set the command, in the unit of the interface.

        Raises:
            InvalidCommandError: The command is not a number.
        """
        try:
            self.command_storage[self.command_index] = command
        except TypeError:
            refuse_non_number(self.name, command)

    @override
    def command_slots(self) -> list[tuple[Storage, int]]:
        return [(self.command_storage, self.command_index)]


class JointStateInterface(HardwareResourceManager[JointStateHandle]):
    """Joint states; reading claims nothing."""

    type_name: ClassVar[str] = "hardware_interface::JointStateInterface"


class JointCommandInterface(HardwareResourceManager[JointHandle]):
    """Joint commands of one kind; asking for a handle claims the joint."""

    type_name: ClassVar[str] = "hardware_interface::JointCommandInterface"
    claims_resources: ClassVar[bool] = True
    start_jump: ClassVar[float] = float("inf")

    @override
    def start_jump_limits(self, name: str) -> list[float]:
        return [self.start_jump]


class EffortJointInterface(JointCommandInterface):
    """Effort commands [Nm or N]."""

    type_name: ClassVar[str] = "hardware_interface::EffortJointInterface"
    start_jump: ClassVar[float] = EFFORT_START_JUMP


class VelocityJointInterface(JointCommandInterface):
    """Velocity commands [rad/s or m/s]."""

    type_name: ClassVar[str] = "hardware_interface::VelocityJointInterface"
    start_jump: ClassVar[float] = VELOCITY_START_JUMP

    @override
    def present_commands(self, name: str) -> list[float]:
        return [self._handles[name].get_velocity()]


class PositionJointInterface(JointCommandInterface):
    """Position commands [rad or m]; a joint rests at its present position."""

    type_name: ClassVar[str] = "hardware_interface::PositionJointInterface"
    start_jump: ClassVar[float] = POSITION_START_JUMP

    @override
    def rest_commands(self, name: str) -> list[float]:
        return [self._handles[name].get_position()]


class ActuatorStateHandle(JointStateHandle):
    """Reads the state of one actuator.

    Arguments, storage and errors are those of `JointStateHandle`. Positions, velocities
    and efforts are those of the motor's shaft, before the gears. Asking for a handle
    claims nothing, because actuators are claimed through their joints.

    Source:
        ros_control@633c374 hardware_interface/actuator_state_interface.h,
        actuator_command_interface.h; differs: a "pointer" is a list of floats and an
        index.
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


class JointCommandMode(IntEnum):
    """The modes a joint can be in, with the numbers of the original.

    Source:
        ros_control@0.20.0 hardware_interface/joint_mode_interface.h.
    """

    BEGIN = -1
    MODE_POSITION = 0
    MODE_VELOCITY = 1
    MODE_EFFORT = 2
    NOMODE = 3
    EMERGENCY_STOP = 4
    SWITCHING = 5
    ERROR = 6


_NAMES = {
    JointCommandMode.BEGIN: "not_operational",
    JointCommandMode.MODE_POSITION: "position",
    JointCommandMode.MODE_VELOCITY: "velocity",
    JointCommandMode.MODE_EFFORT: "effort",
    JointCommandMode.NOMODE: "other",
    JointCommandMode.EMERGENCY_STOP: "emergency_stop",
    JointCommandMode.SWITCHING: "switching",
    JointCommandMode.ERROR: "error",
}


class JointModeHandle(ResourceHandle):
    """Reads and sets the mode of one joint.

    Args:
        name: Name of the joint.
        mode: The robot's modes; slot `index` is this joint's.
        index: The joint's slot.

    Raises:
        HardwareInterfaceError: `mode` is None or has no slot `index`.
    """

    def __init__(
        self, name: str, mode: list[JointCommandMode] | None, index: int = 0
    ) -> None:
        super().__init__(name)
        if mode is None or not 0 <= index < len(mode):
            raise HardwareInterfaceError(
                "Cannot create mode interface. Mode data pointer is null.",
                remedy="Pass the list in which the robot keeps the joints' modes.",
                details={"resource": name, "index": index},
            )
        self._modes = mode
        self._index = index

    def set_mode(self, mode: JointCommandMode) -> None:
        """Request the mode `mode`."""
        self._modes[self._index] = mode

    def get_mode(self) -> JointCommandMode:
        """Return the mode."""
        return self._modes[self._index]

    def get_mode_name(self, mode: JointCommandMode) -> str:
        """Return the name of `mode`, such as `position`."""
        return _NAMES.get(mode, "unknown")


class JointModeInterface(HardwareResourceManager[JointModeHandle]):
    """The modes of joints."""

    type_name: ClassVar[str] = "hardware_interface::JointModeInterface"
