"""Joints commanded by several values at once: position, velocity, and more.

Source: ros_control@0.20.0 hardware_interface/posvel_command_interface.h,
posvelacc_command_interface.h, position_velocity_torque_gains_command_interface.h;
differs: a "pointer" is a list of floats and an index.
"""

import math
from typing import ClassVar, TypeVar

from typing_extensions import override

from station.core.hardware.interfaces.joint import (
    EFFORT_START_JUMP,
    POSITION_START_JUMP,
    VELOCITY_START_JUMP,
    CommandedJointHandle,
    JointStateHandle,
)
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    check_storage,
)
from station.memory.doubles import Storage

ACCELERATION_START_JUMP = 1.0
"""Largest distance of a first acceleration command from rest [rad/s^2 or m/s^2]."""


class PosVelJointHandle(CommandedJointHandle):
    """Reads one joint and commands its position and velocity.

    Args:
        state: State handle of the joint.
        position: The robot's position commands [rad or m].
        velocity: The robot's velocity commands [rad/s or m/s].
        index: The joint's slot in all command lists; None takes that of the state.

    Raises:
        HardwareInterfaceError: A list is None or has no slot `index`.
    """

    def __init__(
        self,
        state: JointStateHandle,
        position: Storage | None,
        velocity: Storage | None,
        index: int | None = None,
    ) -> None:
        super().__init__(state, index)
        self.command_storages: list[Storage] = []
        self.add_command("Command position", position)
        # The original's message has two spaces here.
        self.add_command("Command velocity ", velocity)

    def add_command(self, what: str, storage: Storage | None) -> None:
        """Add a quantity that the handle commands; for constructors.

        Args:
            what: Name of the quantity in an error message, as the original spells it.
            storage: The robot's commands of this quantity.

        Raises:
            HardwareInterfaceError: `storage` is None or has no slot for the joint.
        """
        checked = check_storage(
            self.name, what, storage, self.command_index, kind="pointer"
        )
        self.command_storages.append(checked)

    def set_command(self, position: float, velocity: float) -> None:
        """Command a position [rad or m] and a velocity [rad/s or m/s]."""
        self.set_command_position(position)
        self.set_command_velocity(velocity)

    def set_command_position(self, position: float) -> None:
        """Command a position [rad or m]."""
        self.store_command(self.command_storages[0], position)

    def set_command_velocity(self, velocity: float) -> None:
        """Command a velocity [rad/s or m/s]."""
        self.store_command(self.command_storages[1], velocity)

    def get_command_position(self) -> float:
        """Return the position commanded last [rad or m]."""
        return self.command_storages[0][self.command_index]

    def get_command_velocity(self) -> float:
        """Return the velocity commanded last [rad/s or m/s]."""
        return self.command_storages[1][self.command_index]

    @override
    def command_slots(self) -> list[tuple[Storage, int]]:
        return [(storage, self.command_index) for storage in self.command_storages]


class PosVelAccJointHandle(PosVelJointHandle):
    """Reads one joint and commands its position, velocity and acceleration.

    Args:
        state: State handle of the joint.
        position: The robot's position commands [rad or m].
        velocity: The robot's velocity commands [rad/s or m/s].
        acceleration: The robot's acceleration commands [rad/s^2 or m/s^2].
        index: The joint's slot in all command lists; None takes that of the state.

    Raises:
        HardwareInterfaceError: A list is None or has no slot `index`.
    """

    def __init__(
        self,
        state: JointStateHandle,
        position: Storage | None,
        velocity: Storage | None,
        acceleration: Storage | None,
        index: int | None = None,
    ) -> None:
        super().__init__(state, position, velocity, index)
        self.add_command("Command acceleration data", acceleration)

    @override
    def set_command(  # type: ignore[override]  # one value more, as in the original
        self, position: float, velocity: float, acceleration: float
    ) -> None:
        """Command position, velocity and acceleration [rad/s^2 or m/s^2]."""
        super().set_command(position, velocity)
        self.set_command_acceleration(acceleration)

    def set_command_acceleration(self, acceleration: float) -> None:
        """Command an acceleration [rad/s^2 or m/s^2]."""
        self.store_command(self.command_storages[2], acceleration)

    def get_command_acceleration(self) -> float:
        """Return the acceleration commanded last [rad/s^2 or m/s^2]."""
        return self.command_storages[2][self.command_index]


class PositionVelocityTorqueGainsJointHandle(PosVelJointHandle):
    """Reads one joint and commands a position, a velocity, an effort and gains.

    Args:
        state: State handle of the joint.
        position: The robot's position commands [rad or m].
        velocity: The robot's velocity commands [rad/s or m/s].
        effort: The robot's feed-forward efforts [Nm or N].
        kp: The robot's position gains [Nm/rad or N/m].
        kd: The robot's velocity gains [Nm s/rad or N s/m].
        index: The joint's slot in all command lists; None takes that of the state.

    Raises:
        HardwareInterfaceError: A list is None or has no slot `index`.
    """

    def __init__(
        self,
        state: JointStateHandle,
        position: Storage | None,
        velocity: Storage | None,
        effort: Storage | None,
        kp: Storage | None,
        kd: Storage | None,
        index: int | None = None,
    ) -> None:
        super().__init__(state, position, velocity, index)
        self.add_command("Command effort data", effort)
        self.add_command("Command position gain data", kp)
        self.add_command("Command derivative gain data", kd)

    @override
    def set_command(  # type: ignore[override]  # three values more, as in the original
        self, position: float, velocity: float, effort: float, kp: float, kd: float
    ) -> None:
        """Command position, velocity, feed-forward effort and both gains."""
        super().set_command(position, velocity)
        self.set_command_effort(effort)
        self.set_command_kp(kp)
        self.set_command_kd(kd)

    def set_command_effort(self, effort: float) -> None:
        """Command a feed-forward effort [Nm or N]."""
        self.store_command(self.command_storages[2], effort)

    def set_command_kp(self, kp: float) -> None:
        """Command the position gain [Nm/rad or N/m]."""
        self.store_command(self.command_storages[3], kp)

    def set_command_kd(self, kd: float) -> None:
        """Command the velocity gain [Nm s/rad or N s/m]."""
        self.store_command(self.command_storages[4], kd)

    def get_command_effort(self) -> float:
        """Return the feed-forward effort commanded last [Nm or N]."""
        return self.command_storages[2][self.command_index]

    def get_command_kp(self) -> float:
        """Return the position gain commanded last [Nm/rad or N/m]."""
        return self.command_storages[3][self.command_index]

    def get_command_kd(self) -> float:
        """Return the velocity gain commanded last [Nm s/rad or N s/m]."""
        return self.command_storages[4][self.command_index]


PosVelH = TypeVar("PosVelH", bound=PosVelJointHandle)


class PosVelFamilyInterface(HardwareResourceManager[PosVelH]):
    """Base of interfaces with several commands per joint: position, velocity, others.

    Asking for a handle claims the joint, which rests at its present position.

    Attributes:
        further_jumps: Largest distances from rest of the first commands, for the
            quantities after position and velocity.
    """

    claims_resources: ClassVar[bool] = True
    further_jumps: ClassVar[tuple[float, ...]] = ()

    @override
    def rest_commands(self, name: str) -> list[float]:
        handle = self._handles[name]
        further = [0.0 for _ in handle.command_storages[2:]]
        return [handle.get_position(), 0.0, *further]

    @override
    def present_commands(self, name: str) -> list[float]:
        position, _, *further = self.rest_commands(name)
        return [position, self._handles[name].get_velocity(), *further]

    @override
    def start_jump_limits(self, name: str) -> list[float]:
        return [POSITION_START_JUMP, VELOCITY_START_JUMP, *self.further_jumps]


class PosVelJointInterface(PosVelFamilyInterface[PosVelJointHandle]):
    """Position and velocity commands."""

    type_name: ClassVar[str] = "hardware_interface::PosVelJointInterface"


class PosVelAccJointInterface(PosVelFamilyInterface[PosVelAccJointHandle]):
    """Position, velocity and acceleration commands."""

    type_name: ClassVar[str] = "hardware_interface::PosVelAccJointInterface"
    further_jumps: ClassVar[tuple[float, ...]] = (ACCELERATION_START_JUMP,)


class PositionVelocityTorqueGainsJointInterface(
    PosVelFamilyInterface[PositionVelocityTorqueGainsJointHandle]
):
    """Position, velocity, feed-forward effort and gain commands.

    A joint at rest keeps the gains commanded last; without gains it would give way.
    """

    type_name: ClassVar[str] = (
        "hardware_interface::PositionVelocityTorqueGainsJointInterface"
    )
    further_jumps: ClassVar[tuple[float, ...]] = (
        EFFORT_START_JUMP,
        float("inf"),
        float("inf"),
    )

    @override
    def rest_commands(self, name: str) -> list[float]:
        handle = self._handles[name]
        gains = (handle.get_command_kp(), handle.get_command_kd())
        # The gains stay: without them a joint at rest would go limp.
        kept = [gain if math.isfinite(gain) else 0.0 for gain in gains]
        return [handle.get_position(), 0.0, 0.0, *kept]
