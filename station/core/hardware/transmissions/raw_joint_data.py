"""The joints of a robot whose hardware has actuators only."""

from collections.abc import Sequence
from math import nan

from station.core.errors import HardwareInterfaceError
from station.core.hardware.slots import Slot
from station.core.hardware.transmissions.transmission_handle import JointData
from station.memory.doubles import Storage, doubles


class RawJointData:
    """Hold state and commands of joints, one slot per joint.

    Joints that are named at the start have their values side by side in doubles.
    Without names the values are lists, which grow with the joints.

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
        count = len(self.names)
        self.position: Storage = [] if joints is None else doubles([nan] * count)
        self.velocity: Storage = [] if joints is None else doubles([nan] * count)
        self.effort: Storage = [] if joints is None else doubles([nan] * count)
        self.absolute_position: Storage = (
            [] if joints is None else doubles([nan] * count)
        )
        self.torque_sensor: Storage = [] if joints is None else doubles([nan] * count)
        self.position_command: Storage = (
            [] if joints is None else doubles([nan] * count)
        )
        self.velocity_command: Storage = (
            [] if joints is None else doubles([nan] * count)
        )
        self.effort_command: Storage = [] if joints is None else doubles([nan] * count)
        self._states = {
            "position": self.position,
            "velocity": self.velocity,
            "effort": self.effort,
            "absolute_position": self.absolute_position,
            "torque_sensor": self.torque_sensor,
        }
        self._commands = {
            "position": self.position_command,
            "velocity": self.velocity_command,
            "effort": self.effort_command,
        }

    def add(self, name: str) -> int:
        """Return the slot of a joint; a joint without a slot gets a new one.

        Args:
            name: Name of the joint.

        Returns:
            The index in all values.

        Raises:
            HardwareInterfaceError: Other joints were named at the start.
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
