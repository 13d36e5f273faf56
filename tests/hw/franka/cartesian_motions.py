"""The Cartesian motion generator of an arm without a world."""

from collections.abc import Sequence

from station.core.franka import ArmError, RobotState
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.arm.supervisor_limits import SupervisorLimits
from station.hw.franka.simulated.arm_cycle import ArmCycle
from station.hw.franka.simulated.cartesian_motion import CartesianMotion, Elbow
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.memory.doubles import put

PERIOD = 0.001


class Generator:
    """A motion generator that is given its commands call by call."""

    def __init__(self, state: RobotState) -> None:
        memory = SimulatorMemory(7)
        cycle = ArmCycle(state, PANDA_LIMITS, SupervisorLimits(), memory, PERIOD)
        self._step = cycle.cartesian
        self._motion = CartesianMotion(state, PANDA_LIMITS, self._step, PERIOD)
        self.begin = self._motion.begin
        self.extrapolate = self._motion.extrapolate

    def receive(
        self, values: Sequence[float], elbow: Elbow | None = None
    ) -> list[ArmError]:
        """Plan a cycle for a pose or a twist; return the errors of the command."""
        put(self._step.command[: len(values)], values)
        self._step.size = len(values)
        return self._motion.plan(elbow)

    def solve(self) -> tuple[list[float], list[ArmError]]:
        """Return the joints' next positions and the errors of their step."""
        errors = self._motion.solve()
        return [*self._step.target], errors
