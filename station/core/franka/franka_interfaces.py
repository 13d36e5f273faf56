"""The whole state of an arm, and Cartesian commands of its end effector.

Source: franka_ros@c11f000 franka_hw/include/franka_hw/franka_state_interface.h,
franka_cartesian_command_interface.h; differs: when a controller starts, the commands
rest at the desired pose of the end effector.
"""

from collections.abc import Callable, Sequence
from typing import ClassVar

from typing_extensions import override

from station.core.franka.franka_robot_state import RobotState
from station.core.franka.model_sources import ModelSource
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
)
from station.memory.doubles import Doubles, Storage, put, zeros


class FrankaStateHandle(ResourceHandle):
    """Reads the state of one arm. Control thread only.

    Args:
        name: Name of the form `<arm_id>_robot`.
        state: The arm's live state.
        refresh: Brings the derived fields of `state` up to date; cheap if they already
            are.
        pose: Writes only `O_T_EE`, without a refresh; None to use `refresh`.
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


POSE_SIZE = 16
"""Count of the numbers in a pose."""
TWIST_SIZE = 6
"""Count of the numbers in a twist."""
POSE_START_JUMP = 0.005
"""Largest distance of a first pose command from rest, per element [m or 1]."""
TWIST_START_JUMP = 0.02
"""Largest distance of a first twist command from rest, per element [m/s or rad/s]."""
# A memory, not a tuple, because every cycle copies it, and memory is copied faster.
_ANY_ELBOW = zeros(2)


class FrankaCartesianHandle(FrankaStateHandle):
    """Reads the state of one arm and commands its end effector.

    Args:
        name: Name of the form `<arm_id>_robot`.
        state: The arm's live state.
        refresh: Brings the derived fields of `state` up to date.
        command: The robot's storage of the command.
        elbow: The robot's storage of the elbow command, shape (2,); with two zeros the
            arm chooses its elbow.
    """

    def __init__(
        self,
        name: str,
        state: RobotState,
        refresh: Callable[[], None],
        command: Doubles,
        elbow: Doubles,
    ) -> None:
        super().__init__(name, state, refresh)
        self._command = command
        self._elbow = elbow

    def get_command(self) -> list[float]:
        """Return the last command as a new list."""
        return list(self._command)

    def set_command(
        self, command: Sequence[float], elbow: Sequence[float] = _ANY_ELBOW
    ) -> None:
        """Command the end effector; the robot checks the command when it sends it.

        Args:
            command: Pose O_T_EE, 16 numbers, column-major, or twist O_dP_EE, linear
                [m/s] and angular velocity [rad/s], 6 numbers.
            elbow: Position of joint 3 [rad] and sign of joint 4, +1 or -1; with two
                zeros the arm chooses its elbow.

        Raises:
            TypeError: A value is not a number; nothing was commanded.
            ValueError: There are more or fewer numbers; nothing was commanded.
        """
        put(self._command, command)
        put(self._elbow, elbow)

    @override
    def command_slots(self) -> list[tuple[Storage, int]]:
        # Without the elbow: zeros are its rest, but they are no position.
        return [(self._command, index) for index in range(len(self._command))]


class FrankaCartesianPoseHandle(FrankaCartesianHandle):
    """Commands the pose O_T_EE, 16 numbers, column-major."""


class FrankaCartesianVelocityHandle(FrankaCartesianHandle):
    """Commands the twist O_dP_EE: linear [m/s], then angular velocity [rad/s]."""


class FrankaPoseCartesianInterface(HardwareResourceManager[FrankaCartesianPoseHandle]):
    """Pose commands by arm; asking for a handle claims the arm."""

    type_name: ClassVar[str] = "franka_hw::FrankaPoseCartesianInterface"
    claims_resources: ClassVar[bool] = True

    @override
    def rest_commands(self, name: str) -> list[float]:
        return list(self._handles[name].get_robot_state().O_T_EE_d)

    @override
    def start_jump_limits(self, name: str) -> list[float]:
        return [POSE_START_JUMP] * POSE_SIZE


class FrankaVelocityCartesianInterface(
    HardwareResourceManager[FrankaCartesianVelocityHandle]
):
    """Twist commands by arm; asking for a handle claims the arm."""

    type_name: ClassVar[str] = "franka_hw::FrankaVelocityCartesianInterface"
    claims_resources: ClassVar[bool] = True

    @override
    def start_jump_limits(self, name: str) -> list[float]:
        return [TWIST_START_JUMP] * TWIST_SIZE
