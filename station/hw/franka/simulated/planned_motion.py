"""The motion of joints to target positions, planned by the arm itself.

Ruckig plans it anew when the target changes, within the limits of the arm and the
velocities that the client allows. All joints arrive together.
"""

from collections.abc import Sequence

from ruckig import InputParameter, OutputParameter, Ruckig, RuckigError, Synchronization

from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import ArmLimits
from station.memory.doubles import Doubles, Storage, put, zeros

# Time ahead at which a joint's velocity limit is looked up [s]. The limit decreases by
# up to 17 rad/s^2, faster than the joints may slow down.
_FORESIGHT = 0.03
# Lowest velocity bound for a plan [rad/s]; Ruckig accepts no bound of 0.
_SLOWEST = 1e-3


class PlannedMotion:
    """Plans from the arm's desired motion to the newest target. Control thread.

    Args:
        memory: State of the joints; the plan begins at `q_d` and `dq_d`.
        limits: The arm's limits.
        period: Duration of a cycle [s], > 0.
    """

    def __init__(self, memory: JointMemory, limits: ArmLimits, period: float) -> None:
        self._limits = limits
        self._fastest = list(limits.velocity)
        self._next = zeros(memory.size)
        self._ruckig = Ruckig(memory.size, period)
        self._output = OutputParameter(memory.size)
        self._input = plan = InputParameter(memory.size)
        plan.max_acceleration = list(limits.acceleration)
        plan.max_jerk = list(limits.jerk)
        plan.current_position = [*memory.q_d]
        plan.current_velocity = [*memory.dq_d]
        plan.current_acceleration = [*memory.ddq_d]

    def aim(self, q: Storage, fastest: Sequence[float]) -> None:
        """Set target positions.

        Args:
            q: Positions within the limits [rad], shape (n,).
            fastest: Largest velocities, > 0 [rad/s], shape (n,); the arm's own limits
                apply, too.
        """
        pairs = zip(fastest, self._limits.velocity, strict=True)
        self._fastest = [min(pair) for pair in pairs]
        self._input.target_position = [*q]
        self._input.max_velocity = self._fastest

    def advance(self) -> Doubles:
        """Return the next positions [rad], shape (n,), in the same memory each time."""
        if self._limits.curves:
            self._bend_velocity_limits()
        try:
            self._ruckig.update(self._input, self._output)
        except RuckigError:
            # In rare cases no plan lets all joints arrive together; then each joint
            # arrives by itself.
            self._input.synchronization = Synchronization.No
            self._ruckig.update(self._input, self._output)
            self._input.synchronization = Synchronization.Time
        self._output.pass_to_input(self._input)
        put(self._next, self._output.new_position)
        return self._next

    def _bend_velocity_limits(self) -> None:
        """Slow the plan down where joints approach position-dependent limits."""
        plan = self._input
        ahead = zip(plan.current_position, plan.current_velocity, strict=True)
        highest, lowest = [], []
        for joint, (q, dq) in enumerate(ahead):
            fastest = self._fastest[joint]
            low, high = self._limits.velocity_range(joint, q + dq * _FORESIGHT)
            highest.append(max(_SLOWEST, min(high, fastest)))
            lowest.append(min(-_SLOWEST, max(low, -fastest)))
        plan.max_velocity, plan.min_velocity = highest, lowest
