"""The Cartesian motion generator of an arm without a world."""

from collections.abc import Sequence

from station.core.franka import ArmError, RobotState
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.simulated.arm_parts import new_joint_memory
from station.hw.franka.simulated.cartesian_step import CartesianStep
from station.hw.franka.simulated.motion_check import MotionCheck
from station.memory.doubles import put

PERIOD = 0.001


class Generator:
    """A motion generator that is given its commands call by call."""

    def __init__(self, state: RobotState) -> None:
        self._memory = new_joint_memory(state)
        check = MotionCheck(self._memory, PANDA_LIMITS, PERIOD)
        self._step = CartesianStep(self._memory, check, state.doubles, CHAIN, PERIOD)
        self._violations = check.violations
        self._is_first = True
        self.begin = self._step.begin_motion
        self.extrapolate = self._step.extrapolate

    def receive(
        self, values: Sequence[float], elbow: tuple[float, float] | None = None
    ) -> list[ArmError]:
        """Plan a cycle for a pose or a twist; return the errors of the command."""
        step = self._step
        put(step.command[: len(values)], values)
        step.size, step.has_elbow = len(values), elbow is not None
        put(step.elbow_command, elbow or (0.0, 0.0))
        self._violations.count = 0
        step.plan(self._is_first)
        self._is_first = False
        return self._violations.errors()

    def solve(self) -> tuple[list[float], list[ArmError]]:
        """Return the joints' next positions and the errors of their step."""
        self._violations.count = 0
        self._step.move_joints()
        return [*self._memory.target], self._violations.errors()
