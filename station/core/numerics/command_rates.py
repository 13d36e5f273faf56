"""Low-pass filter and rate limits of joint commands, as libfranka has them.

Source: libfranka@0.9.2 src/lowpass_filter.cpp, lowpassFilter; src/rate_limiting.cpp,
limitRate; src/control_loop.cpp, convertMotion and ControlLoop::spinControl.
"""

from collections.abc import Iterable

from station.memory.doubles import Doubles, Storage, own, own_zeros
from station.memory.functions import square_root
from station.memory.vectors import copy_into

_INF = float("inf")


def filter_commands(
    values: Storage,
    last: Doubles,
    gain: float,
    largest: float,
    result: Storage,
    size: int,
) -> None:
    """Write the first-order low-pass of commands, with limited steps.

    One loop does both, because a second one costs an interpreted cycle 1 us.

    Args:
        values: The new commands, shape (size,).
        last: The commands of the last cycle, shape (>= size,).
        gain: Share of the new commands, 0 to 1; 1 is off.
        largest: Largest step from the last command, > 0; infinity is off.
        result: Receives the output, shape (>= size,); may be `values`. NaN stays NaN.
        size: Number of commands.
    """
    rest, limits_steps = 1.0 - gain, largest < _INF
    for i in range(size):
        value, before = values[i], last[i]
        if gain < 1.0:
            value = gain * value + rest * before
        if limits_steps:
            step = value - before
            if step > largest:
                step = largest
            elif step < -largest:
                step = -largest
            value = before + step
        result[i] = value


def limited(
    velocity: float,
    last_velocity: float,
    last_acceleration: float,
    acceleration: float,
    jerk: float,
    lowest_velocity: float,
    highest_velocity: float,
    period: float,
) -> float:
    """Return the velocity nearest to a command that all limits allow.

    Close to the velocity limit the acceleration is limited further, so that it can
    reach zero at the limit without exceeding the jerk limit.

    Args:
        velocity: The new command [rad/s].
        last_velocity: The last command [rad/s].
        last_acceleration: Its acceleration [rad/s^2].
        acceleration: Largest acceleration, > 0 [rad/s^2].
        jerk: Largest jerk, > 0 [rad/s^3].
        lowest_velocity: Lowest velocity [rad/s].
        highest_velocity: Highest velocity [rad/s].
        period: Duration of a cycle, > 0 [s].
    """
    change = ((velocity - last_velocity) / period - last_acceleration) / period
    if jerk < change:
        change = jerk
    if change < -jerk:
        change = -jerk
    wanted = last_acceleration + change * period
    slope = jerk / acceleration
    # The acceleration from which the jerk limit still leads to 0 at the velocity limit.
    highest = slope * (highest_velocity - last_velocity)
    if acceleration < highest:
        highest = acceleration
    lowest = slope * (lowest_velocity - last_velocity)
    if lowest < -acceleration:
        lowest = -acceleration
    if highest < wanted:
        wanted = highest
    if wanted < lowest:
        wanted = lowest
    return last_velocity + wanted * period


class CommandRates:
    """Filters and limits the commands of n joints, one kind per cycle.

    Args:
        tau_J_d: Desired torques of the last cycle [Nm], shape (n,). New commands are
            compared with these and with the next three, which are of that cycle, too.
        q_d: Desired positions [rad].
        dq_d: Desired velocities [rad/s].
        ddq_d: Desired accelerations [rad/s^2].
        positions: Commanded positions within the joint limits [rad], shape (n,).
        velocities: Commanded velocities [rad/s].
        efforts: Commanded torques [Nm].
        velocity: Largest speeds [rad/s], shape (n,).
        acceleration: Largest accelerations [rad/s^2].
        jerk: Largest jerks [rad/s^3].
        torque_rate: Largest rate of torques [Nm/s].
        lower: Lowest positions of goals [rad].
        upper: Highest positions of goals [rad].
        braking_share: Share of the acceleration with which a joint approaches its goal.
        approach_gain: Velocity per distance near the goal [1/s].
        period: Duration of a cycle, > 0 [s].
        passes_first: Whether the low-pass lets the first positions of a motion pass
            unchanged.

    Attributes:
        gain: Share of a new command in the low-pass; 1 is off.
        is_limiting: Whether the rates are limited.
        lowest: Lowest velocities at the present positions [rad/s], shape (n,).
        highest: Highest velocities at the present positions [rad/s].
        goals: The positions that the controllers commanded [rad].
        has_goals: Whether `goals` were noted in an earlier cycle of this motion.
        passes_next: Whether the low-pass lets the next positions pass unchanged.
        result: The command to send, shape (n,).
    """

    def __init__(
        self,
        *,
        tau_J_d: Doubles,  # noqa: N803 - libfranka's name
        q_d: Doubles,
        dq_d: Doubles,
        ddq_d: Doubles,
        positions: Doubles,
        velocities: Doubles,
        efforts: Doubles,
        velocity: Iterable[float],
        acceleration: Iterable[float],
        jerk: Iterable[float],
        torque_rate: float,
        lower: Iterable[float],
        upper: Iterable[float],
        braking_share: float,
        approach_gain: float,
        period: float,
        passes_first: bool = False,
    ) -> None:
        self.size = size = len(positions)
        self.tau_J_d = tau_J_d
        self.q_d = q_d
        self.dq_d = dq_d
        self.ddq_d = ddq_d
        self.positions = positions
        self.velocities = velocities
        self.efforts = efforts
        self.velocity = own(velocity)
        self.acceleration = own(acceleration)
        self.jerk = own(jerk)
        # Twice the deceleration of an approach: v^2 = 2 a s.
        self.stopping = own([
            2.0 * braking_share * value for value in self.acceleration
        ])
        self.torque_step = torque_rate * period
        self.lower = own(lower)
        self.upper = own(upper)
        self.approach_gain = approach_gain
        self.passes_first = passes_first
        self.period = period
        self.gain = 1.0
        self.is_limiting = False
        self.highest = own(self.velocity)
        self.lowest = own([-value for value in self.velocity])
        self.goals = own_zeros(size)
        self.last_goals = own_zeros(size)
        self.has_goals = False
        self.passes_next = False
        self.result = own_zeros(size)

    def begin_motion(self, gain: float, is_limiting: bool) -> None:  # noqa: FBT001 - C
        """Forget all previous commands.

        Args:
            gain: Share of a new command in the low-pass; 1 is off.
            is_limiting: Whether the rates are limited.
        """
        self.gain = gain
        self.is_limiting = is_limiting
        self.has_goals = False
        self.passes_next = self.passes_first
        self.note_goals()

    def note_goals(self) -> None:
        """Note the commanded positions, which joint limits may change, as goals.

        With rate limits the arm approaches a goal so that it can stop there.
        """
        if self.is_limiting:
            copy_into(self.goals, 0, self.positions, self.size)

    def filter_torques(self) -> None:
        """Compute the torques to send."""
        largest = self.torque_step if self.is_limiting else _INF
        filter_commands(
            self.efforts, self.tau_J_d, self.gain, largest, self.result, self.size
        )

    def filter_velocities(self) -> None:
        """Compute the velocities to send."""
        result, period = self.result, self.period
        dq_d, ddq_d = self.dq_d, self.ddq_d
        filter_commands(self.velocities, dq_d, self.gain, _INF, result, self.size)
        if not self.is_limiting:
            return
        accelerations, jerks = self.acceleration, self.jerk
        lowest, highest = self.lowest, self.highest
        for i in range(self.size):
            result[i] = limited(
                result[i],
                dq_d[i],
                ddq_d[i],
                accelerations[i],
                jerks[i],
                lowest[i],
                highest[i],
                period,
            )

    def filter_positions(self) -> None:
        """Compute the positions to send, towards the noted goals."""
        result, period = self.result, self.period
        q_d, dq_d, ddq_d = self.q_d, self.dq_d, self.ddq_d
        gain = 1.0 if self.passes_next else self.gain
        self.passes_next = False
        positions, rest = self.positions, 1.0 - gain
        if not self.is_limiting:
            filter_commands(positions, q_d, gain, _INF, result, self.size)
            return
        goals, last_goals = self.goals, self.last_goals
        lower, upper, has_goals = self.lower, self.upper, self.has_goals
        self.has_goals = True
        speeds, accelerations, jerks = self.velocity, self.acceleration, self.jerk
        lows, highs = self.lowest, self.highest
        stopping, approach = self.stopping, self.approach_gain
        for i in range(self.size):
            last, goal = q_d[i], goals[i]
            if upper[i] < goal:
                goal = upper[i]
            if goal < lower[i]:
                goal = lower[i]
            # The first goal counts as one at rest, because there is none before it.
            last_goal = last_goals[i] if has_goals else goal
            last_goals[i] = goal
            position, velocity, last_acceleration = positions[i], dq_d[i], ddq_d[i]
            # As in `filter_commands`, without its loop.
            if gain < 1.0:
                position = gain * position + rest * last
            if (
                position == last
                and goal == last
                and last_goal == last
                and velocity == 0.0
                and last_acceleration == 0.0
                and lows[i] <= 0.0 <= highs[i]
            ):
                result[i] = last  # the steps below would give the same
                continue
            # The step after which the joint can still stop at its goal.
            goal_velocity, speed = (goal - last_goal) / period, speeds[i]
            if goal_velocity > speed or goal_velocity < -speed:
                goal_velocity = 0.0  # the goal jumps
            distance = goal - last
            if distance < 0.0:
                distance = -distance
            closing = approach * distance
            room = stopping[i] * distance
            if room < closing * closing:
                closing = square_root(room)
            low = last + (goal_velocity - closing) * period
            high = last + (goal_velocity + closing) * period
            if high < position:
                position = high
            if position < low:
                position = low
            velocity = limited(
                (position - last) / period,
                velocity,
                last_acceleration,
                accelerations[i],
                jerks[i],
                lows[i],
                highs[i],
                period,
            )
            result[i] = last + velocity * period
