"""The whole state of an arm; reading claims nothing.

Source: franka_ros@c11f000 franka_hw/include/franka_hw/franka_state_interface.h.
"""

from collections.abc import Callable
from typing import ClassVar

from station.core.franka.franka_robot_state import RobotState
from station.core.franka.model_sources import ModelSource
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
)
from station.memory.doubles import Doubles


class FrankaStateHandle(ResourceHandle):
    """Reads the state of one arm. Control thread only.

    Args:
        name: `<arm_id>_robot`.
        state: The arm's live state.
        refresh: Brings the derived fields of `state` up to date; cheap if they are.
        pose: Writes `O_T_EE` alone, without a refresh; None if nothing does.
    """

    def __init__(
        self,
        name: str,
        state: RobotState,
        refresh: Callable[[], None],
        pose: ModelSource | None = None,
    ) -> None:
        super().__init__(name)
        self._state = state
        self._refresh = refresh
        self._pose = pose or ModelSource(self._write_pose)

    def get_robot_state(self) -> RobotState:
        """Return the live state with every field of this cycle up to date."""
        self._refresh()
        return self._state

    def pose_source(self) -> ModelSource:
        """Return a source of `O_T_EE` for every cycle, without the other fields."""
        return self._pose

    def _write_pose(self, result: Doubles) -> None:
        result[:] = self.get_robot_state().doubles("O_T_EE")


class FrankaStateInterface(HardwareResourceManager[FrankaStateHandle]):
    """States of arms by name."""

    type_name: ClassVar[str] = "franka_hw::FrankaStateInterface"
