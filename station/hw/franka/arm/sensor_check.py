"""Find joint readings that are not finite."""

from station.core.franka.franka_robot_state import RobotState
from station.kernel.finite_check import FiniteCheck

_READINGS = ("position", "velocity", "torque")


class SensorCheck:
    """Looks at the joint readings of an arm once per cycle.

    Args:
        state: The arm's state.

    Attributes:
        first_bad: Return the number of the first reading that is not finite; -1 when
            all are.
    """

    def __init__(self, state: RobotState) -> None:
        self._readings = state.readings()
        self.first_bad = FiniteCheck(self._readings).first_bad

    def describe(self, index: int) -> str:
        """Return which joint reading is not finite, in words.

        Args:
            index: What `first_bad` has returned, >= 0.
        """
        reading, joint = divmod(index, 7)
        value = self._readings[index]
        return f"the {_READINGS[reading]} of joint{joint + 1} reads {value}"
