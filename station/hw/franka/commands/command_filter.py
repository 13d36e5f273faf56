"""Filter and limit joint commands between FrankaHW and the arm."""

from collections.abc import Sequence
from math import sqrt

from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.commands.rate_limiter import (
    MAX_CUTOFF_FREQUENCY,
    PERIOD,
    RateLimits,
    VelocityRange,
    limit_position,
    limit_rate,
    limit_velocity,
    low_pass,
    rate_limits_of,
    velocity_range_of,
)

# A joint approaches its goal with half of the acceleration limit, and near the goal
# with a velocity in proportion to the distance [1/s]. Where the two meet, the
# deceleration is up to twice as large, which is why half of the limit is kept.
_BRAKING_SHARE = 0.5
_APPROACH_GAIN = 50.0
_ANY_POSITION = [None] * 7


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
    """

    def __init__(self, limits: ArmLimits) -> None:
        self._arm_limits = limits
        self._limits = rate_limits_of(limits)
        self._is_first = False
        self._cutoff_frequency = MAX_CUTOFF_FREQUENCY
        self._is_limiting = False
        self._last_goals: list[float] | None = None

    def begin(self, *, cutoff_frequency: float, rate_limiting: bool) -> None:
        """Forget all previous commands; called when a motion starts.

        Args:
            cutoff_frequency: Cutoff frequency of the low-pass [Hz], > 0.
            rate_limiting: Whether to limit the rates of commands.
        """
        self._cutoff_frequency = cutoff_frequency
        self._is_limiting = rate_limiting
        self._last_goals = None
        self._is_first = True

    def torques(self, tau: list[float], state: RobotState) -> list[float]:
        """Return the torques to send [Nm], shape (7,)."""
        cutoff = self._cutoff_frequency
        result = [
            low_pass(value, previous, cutoff)
            for value, previous in zip(tau, state.tau_J_d, strict=True)
        ]
        if not self._is_limiting:
            return result
        return [
            limit_rate(value, previous, limits.torque_rate)
            for value, previous, limits in zip(
                result, state.tau_J_d, self._limits, strict=True
            )
        ]

    def velocities(self, dq: list[float], state: RobotState) -> list[float]:
        """Return the velocities to send [rad/s], shape (7,)."""
        cutoff = self._cutoff_frequency
        result = [
            low_pass(value, previous, cutoff)
            for value, previous in zip(dq, state.dq_d, strict=True)
        ]
        if not self._is_limiting:
            return result
        ranges = self._velocity_ranges(state.q_d)
        return [
            limit_velocity(value, velocity, acceleration, limits, allowed)
            for value, velocity, acceleration, limits, allowed in zip(
                result, state.dq_d, state.ddq_d, self._limits, ranges, strict=True
            )
        ]

    def positions(
        self, q: list[float], state: RobotState, *, goals: list[float]
    ) -> list[float]:
        """Return the positions to send [rad], shape (7,).

        Args:
            q: The command after the joint limits [rad], shape (7,).
            state: The arm's state.
            goals: The command of the controller, within the position limits [rad],
                shape (7,).
        """
        cutoff = self._cutoff_frequency
        passes = self._is_first and not self._arm_limits.filters_first_pose
        self._is_first = False
        result = [
            low_pass(value, previous, cutoff)
            for value, previous in zip(q, q if passes else state.q_d, strict=True)
        ]
        if not self._is_limiting:
            return result
        last_goals = self._last_goals or goals
        self._last_goals = list(goals)
        ranges = self._velocity_ranges(state.q_d)
        for i, limits in enumerate(self._limits):
            q_d = state.q_d[i]
            goal_velocity = (goals[i] - last_goals[i]) / PERIOD
            value = _stoppable(result[i], q_d, goals[i], goal_velocity, limits)
            result[i] = limit_position(
                value, q_d, state.dq_d[i], state.ddq_d[i], limits, ranges[i]
            )
        return result

    def _velocity_ranges(self, q_d: Sequence[float]) -> Sequence[VelocityRange | None]:
        """Return the velocities that the positions allow; None without limits."""
        if not self._arm_limits.curves:
            return _ANY_POSITION
        return [
            velocity_range_of(self._arm_limits, i, position)
            for i, position in enumerate(q_d)
        ]


def _stoppable(
    position: float, q_d: float, goal: float, goal_velocity: float, limits: RateLimits
) -> float:
    """Return the step after which a joint can still stop at its goal.

    Args:
        position: Requested position of this cycle [rad].
        q_d: Present desired position [rad].
        goal: Position at which the motion ends [rad].
        goal_velocity: Velocity of the goal [rad/s]; 0 for a goal that makes a step.
        limits: The joint's limits.
    """
    if abs(goal_velocity) > limits.velocity:
        goal_velocity = 0.0
    distance = abs(goal - q_d)
    closing = min(
        sqrt(2.0 * _BRAKING_SHARE * limits.acceleration * distance),
        _APPROACH_GAIN * distance,
    )
    lowest = q_d + (goal_velocity - closing) * PERIOD
    highest = q_d + (goal_velocity + closing) * PERIOD
    return max(lowest, min(highest, position))
