"""Low-pass filter and rate limits of joint commands, as libfranka has them.

Source: libfranka@0.9.2 src/lowpass_filter.cpp, lowpassFilter; src/rate_limiting.cpp,
limitRate; src/control_loop.cpp, convertMotion and ControlLoop::spinControl.
"""

from collections.abc import Iterable

from station.core.franka.joint_memory import JointMemory
from station.memory.doubles import Doubles, own, own_zeros
from station.memory.functions import square_root
from station.memory.vectors import copy_into


def filtered(value: float, previous: float, gain: float) -> float:
    """Return the first-order low-pass of a command.

    Args:
        value: The new command.
        previous: The filter's last output.
        gain: Share of the new command, 0 to 1.
    """
    return gain * value + (1.0 - gain) * previous


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


def limit_steps(values: Doubles, last: Doubles, largest: float) -> None:
    """Replace values by the nearest ones that are at most a step from the last ones.

    Args:
        values: The values, shape (n,); NaN stays.
        last: Those of the last cycle, shape (n,).
        largest: Largest step, > 0.
    """
    for i in range(len(values)):
        before = last[i]
        step = values[i] - before
        if step > largest:
            step = largest
        elif step < -largest:
            step = -largest
        values[i] = before + step


class CommandRates:
    """Filters and limits the commands of n joints, one kind per cycle.

    Args:
        memory: State of the joints; the desired values in it are the last commands.
        positions: Commanded positions within the joint limits [rad], shape (n,).
        velocities: Commanded velocities [rad/s].
        efforts: Commanded torques [Nm].
        velocity: Largest speeds [rad/s], shape (n,).
        acceleration: Largest accelerations [rad/s^2].
        jerk: Largest jerks [rad/s^3].
        torque_rate: Largest rates of torques [Nm/s].
        lower: Lowest positions of goals [rad].
        upper: Highest positions of goals [rad].
        braking_share: Share of the acceleration with which a joint approaches its goal.
        approach_gain: Velocity per distance near the goal [1/s].
        period: Duration of a cycle, > 0 [s].

    Attributes:
        gain: Share of a new command in the low-pass; 1 is off.
        is_limiting: Whether the rates are limited.
        lowest: Lowest velocities at the present positions [rad/s], shape (n,).
        highest: Highest velocities at the present positions [rad/s].
        goals: The controllers' positions [rad].
        has_goals: Whether `goals` were noted in an earlier cycle of this motion.
        passes_next: Whether the low-pass lets the next positions pass unchanged.
        result: The command to send, shape (n,).
    """

    def __init__(
        self,
        memory: JointMemory,
        *,
        positions: Doubles,
        velocities: Doubles,
        efforts: Doubles,
        velocity: Iterable[float],
        acceleration: Iterable[float],
        jerk: Iterable[float],
        torque_rate: Iterable[float],
        lower: Iterable[float],
        upper: Iterable[float],
        braking_share: float,
        approach_gain: float,
        period: float,
    ) -> None:
        size = memory.size
        self.memory = memory
        self.size = size
        self.positions = positions
        self.velocities = velocities
        self.efforts = efforts
        self.velocity = own(velocity)
        self.acceleration = own(acceleration)
        self.jerk = own(jerk)
        # What the approach of a goal takes of each joint.
        self.stopping = own([
            2.0 * braking_share * value for value in self.acceleration
        ])
        self.slope = own([
            j / a for j, a in zip(self.jerk, self.acceleration, strict=True)
        ])
        self.torque_step = own([rate * period for rate in torque_rate])
        self.lower = own(lower)
        self.upper = own(upper)
        self.approach_gain = approach_gain
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

    def note_goals(self) -> None:
        """Note the commanded positions, which joint limits may change, as goals.

        With rate limits the arm approaches a goal so that it can stop there.
        """
        if not self.is_limiting:
            return
        copy_into(self.goals, 0, self.positions, self.size)

    def filter_torques(self) -> None:
        """Compute the torques to send."""
        tau = self.efforts
        last, result, gain = self.memory.tau_J_d, self.result, self.gain
        rest = 1.0 - gain
        steps, is_limiting = self.torque_step, self.is_limiting
        for i in range(self.size):
            value, previous = tau[i], last[i]
            if gain < 1.0:
                value = gain * value + rest * previous
            if is_limiting:
                step = steps[i]
                change = value - previous
                if step < change:
                    change = step
                if change < -step:
                    change = -step
                value = previous + change
            result[i] = value

    def filter_velocities(self) -> None:
        """Compute the velocities to send."""
        memory, result, dq = self.memory, self.result, self.velocities
        dq_d, ddq_d, gain, period = memory.dq_d, memory.ddq_d, self.gain, self.period
        accelerations, jerks = self.acceleration, self.jerk
        lowest, highest = self.lowest, self.highest
        for i in range(self.size):
            value = dq[i]
            if gain < 1.0:
                value = filtered(value, dq_d[i], gain)
            if self.is_limiting:
                value = limited(
                    value,
                    dq_d[i],
                    ddq_d[i],
                    accelerations[i],
                    jerks[i],
                    lowest[i],
                    highest[i],
                    period,
                )
            result[i] = value

    def filter_positions(self) -> None:
        """Compute the positions to send, towards the noted goals."""
        memory, result, gain = self.memory, self.result, self.gain
        passes = self.passes_next
        self.passes_next = False
        q = self.positions
        q_d, dq_d, ddq_d, period = memory.q_d, memory.dq_d, memory.ddq_d, self.period
        if passes:
            gain = 1.0
        rest = 1.0 - gain
        if not self.is_limiting:
            for i in range(self.size):
                value = q[i]
                if gain < 1.0:
                    value = gain * value + rest * q_d[i]
                result[i] = value
            return
        goals, last_goals = self.goals, self.last_goals
        lower, upper, has_goals = self.lower, self.upper, self.has_goals
        self.has_goals = True
        speeds, accelerations, jerks = self.velocity, self.acceleration, self.jerk
        lows, highs = self.lowest, self.highest
        stopping, slopes, approach = self.stopping, self.slope, self.approach_gain
        for i in range(self.size):
            last, goal, acceleration = q_d[i], goals[i], accelerations[i]
            if upper[i] < goal:
                goal = upper[i]
            if goal < lower[i]:
                goal = lower[i]
            last_goal = last_goals[i] if has_goals else goal
            last_goals[i] = goal
            position, velocity, last_acceleration = q[i], dq_d[i], ddq_d[i]
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
                result[i] = last  # what follows would come to the same
                continue
            # The step after which the joint can still stop at its goal.
            goal_velocity, speed = (goal - last_goal) / period, speeds[i]
            if goal_velocity > speed or goal_velocity < -speed:
                goal_velocity = 0.0  # a goal that makes a step
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
            # As `limited`, written out: a call costs more than all of it.
            jerk = jerks[i]
            change = (position - last) / period
            change = ((change - velocity) / period - last_acceleration) / period
            if jerk < change:
                change = jerk
            if change < -jerk:
                change = -jerk
            wanted = last_acceleration + change * period
            slope = slopes[i]
            high = slope * (highs[i] - velocity)
            if acceleration < high:
                high = acceleration
            low = slope * (lows[i] - velocity)
            if low < -acceleration:
                low = -acceleration
            if high < wanted:
                wanted = high
            if wanted < low:
                wanted = low
            result[i] = last + (velocity + wanted * period) * period
