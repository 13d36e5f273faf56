"""Force-torque and inertial sensors; a controller reads them without a claim.

Source: ros_control@0.20.0 hardware_interface/force_torque_sensor_interface.h,
imu_sensor_interface.h.
"""

from typing import ClassVar

from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
    check_storage,
)


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
