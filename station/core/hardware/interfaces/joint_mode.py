"""Changing the control mode of a joint; asking for a handle claims nothing.

Source: ros_control@0.20.0 hardware_interface/joint_mode_interface.h.
"""

from enum import IntEnum
from typing import ClassVar

from station.core.errors import HardwareInterfaceError
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
)


class JointCommandMode(IntEnum):
    """The modes a joint can be in, with the numbers of the original."""

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
