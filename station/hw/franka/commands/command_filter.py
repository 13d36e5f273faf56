"""Filter and limit joint commands between FrankaHW and the arm."""

from collections.abc import Callable

from station.core.franka.command_rates import CommandRates
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.commands.joint_commands import JointCommands
from station.hw.franka.commands.rate_limiter import (
    PERIOD,
    low_pass_gain,
    rate_limits_of,
    velocity_range_of,
)

# A joint approaches its goal with half of the acceleration limit, and near the goal
# with a velocity in proportion to the distance [1/s]. Where the two meet, the
# deceleration is up to twice as large, which is why half of the limit is kept.
_BRAKING_SHARE = 0.5
_APPROACH_GAIN = 50.0


class CommandFilter:
    """Filters and limits the commands of an arm, one kind per cycle.

    Each new command is compared with the desired values that the arm reports, so the
    filter starts smoothly from every earlier motion. Control thread only.

    Source: libfranka@0.9.2 src/control_loop.cpp, convertMotion and
    ControlLoop::spinControl; differs: a position command that breaks the limits, e.g. a
    step, is approached with a velocity from which the arm can stop there, instead of
    with full speed; commands within the limits pass unchanged, as there. Limits that
    depend on the position and the first position of a motion: libfranka@0.15.0.

    Args:
        limits: The arm's own limits.
        state: The arm's state.
        commands: The commands after the joint limits.

    Attributes:
        rates: The arithmetic.
    """

    def __init__(
        self, limits: ArmLimits, state: RobotState, commands: JointCommands
    ) -> None:
        self._arm_limits = limits
        self._state = state
        rates = rate_limits_of(limits)
        lower, upper = commands.range()
        names = ("tau_J_d", "q_d", "dq_d", "ddq_d")
        self.rates = CommandRates(
            JointMemory(7, **{name: state.doubles(name) for name in names}),
            positions=commands.positions,
            velocities=commands.velocities,
            efforts=commands.efforts,
            velocity=[one.velocity for one in rates],
            acceleration=[one.acceleration for one in rates],
            jerk=[one.jerk for one in rates],
            torque_rate=[one.torque_rate for one in rates],
            lower=lower,
            upper=upper,
            braking_share=_BRAKING_SHARE,
            approach_gain=_APPROACH_GAIN,
            period=PERIOD,
        )

    def begin(self, *, cutoff_frequency: float, rate_limiting: bool) -> None:
        """Forget all previous commands; called when a motion starts.

        Args:
            cutoff_frequency: Cutoff frequency of the low-pass [Hz], > 0.
            rate_limiting: Whether to limit the rates of commands.
        """
        self.rates.gain = low_pass_gain(cutoff_frequency)
        self.rates.is_limiting = rate_limiting
        self.rates.has_goals = False
        self.rates.passes_next = not self._arm_limits.filters_first_pose

    @property
    def prepare(self) -> Callable[[], None] | None:
        """What has to be done before positions or velocities are filtered."""
        return self._note_ranges if self._arm_limits.curves else None

    def _note_ranges(self) -> None:
        """Note the velocities that the present positions allow."""
        for i, position in enumerate(self._state.q_d):
            lowest, highest = velocity_range_of(self._arm_limits, i, position)
            self.rates.lowest[i], self.rates.highest[i] = lowest, highest
