"""Map between actuator space and joint space."""

from abc import ABC, abstractmethod

from station.core.errors import HardwareInterfaceError


class TransmissionInterfaceError(HardwareInterfaceError, ValueError):
    """A transmission cannot be described, built or connected.

    Source:
        ros_control@633c374 transmission_interface_exception.h,
        TransmissionInterfaceException; differs: the message also says what to do.
    """

    code = "transmission_interface"


class Transmission(ABC):
    """Map positions, velocities and efforts of some actuators to those of some joints.

    Contract: the maps are pure functions. They take one value per actuator (or joint)
    in a fixed order and return a new list with one value per joint (or actuator). The
    maps of a quantity in both directions are inverse to each other. An ideal
    transmission preserves power: the sum of the products of effort and velocity is
    equal on both sides. The control thread calls the maps every cycle.

    Absolute encoders and torque sensors sit on the actuator side. By default they are
    mapped like position and effort.

    Attributes:
        num_actuators: Dimension of the actuator space.
        num_joints: Dimension of the joint space.

    Source:
        ros_control@633c374 transmission.h, Transmission; differs: maps return values
        and leave pointers to the handles, and absolute position and torque sensor have
        a default.
    """

    num_actuators: int = 1
    num_joints: int = 1

    @abstractmethod
    def actuator_to_joint_effort(self, effort: list[float]) -> list[float]:
        """Return joint efforts [N*m or N] for actuator efforts [N*m or N]."""

    @abstractmethod
    def actuator_to_joint_velocity(self, velocity: list[float]) -> list[float]:
        """Return joint velocities [rad/s or m/s] for actuator velocities."""

    @abstractmethod
    def actuator_to_joint_position(self, position: list[float]) -> list[float]:
        """Return joint positions [rad or m] for actuator positions."""

    def actuator_to_joint_absolute_position(self, position: list[float]) -> list[float]:
        """Return joint positions [rad or m] for actuator-side absolute encoders."""
        return self.actuator_to_joint_position(position)

    def actuator_to_joint_torque_sensor(self, effort: list[float]) -> list[float]:
        """Return joint efforts [N*m or N] for actuator-side torque sensors."""
        return self.actuator_to_joint_effort(effort)

    @abstractmethod
    def joint_to_actuator_effort(self, effort: list[float]) -> list[float]:
        """Return actuator efforts [N*m or N] for joint efforts [N*m or N]."""

    @abstractmethod
    def joint_to_actuator_velocity(self, velocity: list[float]) -> list[float]:
        """Return actuator velocities [rad/s or m/s] for joint velocities."""

    @abstractmethod
    def joint_to_actuator_position(self, position: list[float]) -> list[float]:
        """Return actuator positions [rad or m] for joint positions."""
