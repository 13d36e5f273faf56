"""Sensors, which controllers read without a claim, and general-purpose in- and outputs.

Source: ros_control@0.20.0 hardware_interface/force_torque_sensor_interface.h,
imu_sensor_interface.h; ros2_control@6.x controller_interface semantic_components
(range_sensor.hpp, magnetic_field_sensor.hpp, gps_sensor.hpp),
battery_state_broadcaster, hardware_interface `<gpio>`; differs: a sensor of ROS 2 is
one handle with all its values.
"""

from collections.abc import Iterable, Mapping
from typing import ClassVar

from typing_extensions import override

from station.core.errors import refuse_non_number
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
    check_storage,
)
from station.memory.doubles import Storage


class ForceTorqueSensorHandle(ResourceHandle):
    """Reads one force-torque sensor.

    Args:
        name: Name of the sensor.
        frame_id: Frame in which the values are expressed.
        force: The robot's storage of the force [N], shape (3,).
        torque: The robot's storage of the torque [Nm], shape (3,).
        is_reaction: Whether the values are the force that holds the part behind the
            sensor. Otherwise they are the force on that part, with the opposite sign.

    Attributes:
        is_reaction: As given.

    Raises:
        HardwareInterfaceError: A storage is None or too short.
    """

    def __init__(
        self,
        name: str,
        frame_id: str,
        force: list[float] | None,
        torque: list[float] | None,
        *,
        is_reaction: bool = False,
    ) -> None:
        super().__init__(name)
        self.is_reaction = is_reaction
        self._frame_id = frame_id
        self._force = check_storage(name, "Force", force, 2)
        self._torque = check_storage(name, "Torque", torque, 2)

    def get_frame_id(self) -> str:
        """Return the frame in which the values are expressed."""
        return self._frame_id

    def get_force(self) -> list[float]:
        """Return the force [N], shape (3,), a new list."""
        return self._force[:3]

    def get_torque(self) -> list[float]:
        """Return the torque [Nm], shape (3,), a new list."""
        return self._torque[:3]


class ForceTorqueSensorInterface(HardwareResourceManager[ForceTorqueSensorHandle]):
    """Force-torque sensors by name."""

    type_name: ClassVar[str] = "hardware_interface::ForceTorqueSensorInterface"


class ImuSensorHandle(ResourceHandle):
    """Reads one inertial measurement unit; every reading may be absent.

    Args:
        name: Name of the sensor.
        frame_id: Frame of the sensor.
        orientation: Quaternion x, y, z, w as in sensor_msgs/Imu, shape (4,).
        orientation_covariance: Row-major about x, y, z [rad^2], shape (9,).
        angular_velocity: Angular velocity [rad/s], shape (3,).
        angular_velocity_covariance: Row-major [rad^2/s^2], shape (9,).
        linear_acceleration: Linear acceleration [m/s^2], shape (3,).
        linear_acceleration_covariance: Row-major [m^2/s^4], shape (9,).

    Raises:
        HardwareInterfaceError: A storage is too short.
    """

    def __init__(
        self,
        name: str,
        frame_id: str,
        *,
        orientation: list[float] | None = None,
        orientation_covariance: list[float] | None = None,
        angular_velocity: list[float] | None = None,
        angular_velocity_covariance: list[float] | None = None,
        linear_acceleration: list[float] | None = None,
        linear_acceleration_covariance: list[float] | None = None,
    ) -> None:
        super().__init__(name)
        self._frame_id = frame_id
        self._orientation = self._checked("Orientation", orientation, 4)
        self._orientation_covariance = self._checked(
            "Orientation covariance", orientation_covariance, 9
        )
        self._angular_velocity = self._checked("Angular velocity", angular_velocity, 3)
        self._angular_velocity_covariance = self._checked(
            "Angular velocity covariance", angular_velocity_covariance, 9
        )
        self._linear_acceleration = self._checked(
            "Linear acceleration", linear_acceleration, 3
        )
        self._linear_acceleration_covariance = self._checked(
            "Linear acceleration covariance", linear_acceleration_covariance, 9
        )

    def _checked(
        self, what: str, storage: list[float] | None, size: int
    ) -> list[float] | None:
        if storage is None:
            return None
        return check_storage(self.name, what, storage, size - 1)

    def get_frame_id(self) -> str:
        """Return the frame in which the values are expressed."""
        return self._frame_id

    def get_orientation(self) -> list[float] | None:
        """Return the quaternion x, y, z, w, shape (4,), or None if not measured."""
        return _copy(self._orientation)

    def get_orientation_covariance(self) -> list[float] | None:
        """Return the orientation's covariance [rad^2], shape (9,), or None."""
        return _copy(self._orientation_covariance)

    def get_angular_velocity(self) -> list[float] | None:
        """Return the angular velocity [rad/s], shape (3,), or None."""
        return _copy(self._angular_velocity)

    def get_angular_velocity_covariance(self) -> list[float] | None:
        """Return the angular velocity's covariance [rad^2/s^2], shape (9,), or None."""
        return _copy(self._angular_velocity_covariance)

    def get_linear_acceleration(self) -> list[float] | None:
        """Return the linear acceleration [m/s^2], shape (3,), or None."""
        return _copy(self._linear_acceleration)

    def get_linear_acceleration_covariance(self) -> list[float] | None:
        """Return the covariance of the acceleration [m^2/s^4], shape (9,), or None."""
        return _copy(self._linear_acceleration_covariance)


def _copy(values: list[float] | None) -> list[float] | None:
    return None if values is None else list(values)


class ImuSensorInterface(HardwareResourceManager[ImuSensorHandle]):
    """Inertial measurement units by name."""

    type_name: ClassVar[str] = "hardware_interface::ImuSensorInterface"


class ValuesSensorHandle(ResourceHandle):
    """Reads one sensor that has named values.

    Args:
        name: Name of the sensor.
        frame_id: Frame of the sensor; may be empty.
        values: The robot's storage, one number per name, in the unit of the value.
        names: Names of the values, e.g. `magnetic_field.x`.

    Raises:
        HardwareInterfaceError: The storage is None or too short.
    """

    def __init__(
        self, name: str, frame_id: str, values: list[float] | None, names: Iterable[str]
    ) -> None:
        super().__init__(name)
        self._frame_id = frame_id
        self._names = tuple(names)
        self._values = check_storage(name, "Value", values, len(self._names) - 1)

    def get_frame_id(self) -> str:
        """Return the frame of the sensor; empty if it has none."""
        return self._frame_id

    def has(self, value: str) -> bool:
        """Return whether the sensor has a value of that name."""
        return value in self._names

    def get_values(self) -> Mapping[str, float]:
        """Return all values by name, a new mapping."""
        return dict(zip(self._names, self._values, strict=False))


class RangeSensorInterface(HardwareResourceManager[ValuesSensorHandle]):
    """Distances along one direction, the x axis of the frame, by name."""

    type_name: ClassVar[str] = "hardware_interface::RangeSensorInterface"


class MagneticFieldSensorInterface(HardwareResourceManager[ValuesSensorHandle]):
    """Magnetometers by name."""

    type_name: ClassVar[str] = "hardware_interface::MagneticFieldSensorInterface"


class GpsSensorInterface(HardwareResourceManager[ValuesSensorHandle]):
    """Receivers of satellite navigation by name."""

    type_name: ClassVar[str] = "hardware_interface::GpsSensorInterface"


class BatterySensorInterface(HardwareResourceManager[ValuesSensorHandle]):
    """Interface of the batteries, by name."""

    type_name: ClassVar[str] = "hardware_interface::BatterySensorInterface"


SEMANTIC_INTERFACES: Mapping[str, type[HardwareResourceManager[ValuesSensorHandle]]] = {
    "range": RangeSensorInterface,
    "magnetometer": MagneticFieldSensorInterface,
    "gps": GpsSensorInterface,
    "battery": BatterySensorInterface,
}
"""The interface of each kind of sensor with named values."""
SEMANTIC_VALUES: Mapping[str, tuple[str, ...]] = {
    "range": ("range",),
    "magnetometer": tuple(f"magnetic_field.{axis}" for axis in "xyz"),
    "gps": ("status", "service", "latitude", "longitude", "altitude"),
    "battery": ("battery_voltage",),
}
"""Names of the values of each kind of sensor: ranges and altitude [m], field [T],
latitude and longitude [degree], voltage [V], and two numbers of NavSatStatus."""


class GpioStateHandle(ResourceHandle):
    """Reads one input or output.

    Args:
        name: Name of the form `<gpio>/<interface>`, e.g. `flange/vacuum`.
        states: The robot's storage of values.
        index: Slot of the value in the storage.

    Raises:
        HardwareInterfaceError: The storage is None or has no such slot.
    """

    def __init__(self, name: str, states: Storage | None, index: int) -> None:
        super().__init__(name)
        self._index = index
        self._states = check_storage(name, "State", states, index)

    def get_value(self) -> float:
        """Return the value; 0 and 1 for false and true."""
        return self._states[self._index]


class GpioStateInterface(HardwareResourceManager[GpioStateHandle]):
    """Inputs and outputs that can be read, by `<gpio>/<interface>`."""

    type_name: ClassVar[str] = "hardware_interface::GpioStateInterface"


class GpioCommandHandle(ResourceHandle):
    """Commands one output.

    Args:
        name: Name of the form `<gpio>/<interface>`.
        commands: The robot's storage of commands.
        present: The robot's storage of the outputs' present values.
        index: Slot in both storages.

    Raises:
        HardwareInterfaceError: A storage is None or has no such slot.
    """

    def __init__(
        self, name: str, commands: Storage | None, present: Storage | None, index: int
    ) -> None:
        super().__init__(name)
        self._index = index
        self._commands = check_storage(name, "Command", commands, index)
        self._present = check_storage(name, "State", present, index)

    def get_command(self) -> float:
        """Return the value commanded last."""
        return self._commands[self._index]

    def set_command(self, command: float) -> None:
        """Set the command; 0 and 1 for false and true.

        Raises:
            InvalidCommandError: The command is not a number.
        """
        try:
            self._commands[self._index] = command
        except TypeError:
            refuse_non_number(self.name, command)

    def present(self) -> float:
        """Return the value that the output has now."""
        return self._present[self._index]

    @override
    def command_slots(self) -> list[tuple[Storage, int]]:
        return [(self._commands, self._index)]


class GpioCommandInterface(HardwareResourceManager[GpioCommandHandle]):
    """Outputs by `<gpio>/<interface>`; asking for a handle claims the output.

    An output without an owner keeps its value: a gripper must not drop its load because
    a controller has ended.
    """

    type_name: ClassVar[str] = "hardware_interface::GpioCommandInterface"
    claims_resources: ClassVar[bool] = True

    @override
    def rest_commands(self, name: str) -> list[float]:
        return [self._handles[name].present()]
