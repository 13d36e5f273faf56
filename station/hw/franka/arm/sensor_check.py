"""Find joint readings that are not finite."""

from station.core.franka.franka_robot_state import RobotState
from station.kernel.finite_check import FiniteCheck

_READINGS = ("position", "velocity", "torque")


class SensorCheck:
    """Looks at the joint readings of an arm once per cycle.

    Args:
        state: The arm's state.
    """

    def __init__(self, state: RobotState) -> None:
        self._readings = state.readings()
        self._first_bad = FiniteCheck(self._readings).first_bad

    def blind_sensor(self) -> str | None:
        """Return the first joint reading that is not finite; None when all are."""
        index = self._first_bad()
        if index < 0:
            return None
        reading, joint = divmod(index, 7)
        value = self._readings[index]
        return f"the {_READINGS[reading]} of joint{joint + 1} reads {value}"
