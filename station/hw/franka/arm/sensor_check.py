"""Find joint readings that are not finite."""

from station.core.franka.franka_robot_state import RobotState
from station.memory.finite_check import FiniteCheck

_READINGS = ("position", "velocity", "torque")


class SensorCheck:
    """Looks at the joint readings of an arm once per cycle.

    Args:
        state: The arm's state.

    Attributes:
        readings: Looks for a reading that is not finite.
    """

    def __init__(self, state: RobotState) -> None:
        self._memory = state.readings()
        self.readings = FiniteCheck(self._memory)

    def describe(self, index: int) -> str:
        """Return which joint reading is not finite, in words.

        Args:
            index: Number of the reading, as `readings` has found it, >= 0.
        """
        reading, joint = divmod(index, 7)
        value = self._memory[index]
        return f"the {_READINGS[reading]} of joint{joint + 1} reads {value}"
