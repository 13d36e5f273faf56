"""Force-torque sensors; reading claims nothing.

Source: ros_control@0.20.0 hardware_interface/force_torque_sensor_interface.h.
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

    Raises:
        HardwareInterfaceError: A storage is None or too short.
    """

    def __init__(
        self,
        name: str,
        frame_id: str,
        force: list[float] | None,
        torque: list[float] | None,
    ) -> None:
        super().__init__(name)
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
