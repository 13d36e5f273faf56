"""Follow a trajectory in the cycles in which nothing but time passes."""

from collections.abc import Sized
from typing import Any

from station.controllers.set_point_controller import CommandLaw
from station.core.control.sample_columns import SampleColumns
from station.core.control.usual_update import UsualUpdate
from station.core.numerics.pid import PidGroup
from station.core.trajectory.ros_time import to_nanoseconds, uptime_seconds
from station.core.trajectory.splines import SplineGroup
from station.memory.doubles import Doubles, zeros

_INF = float("inf")


class SpeedFactor:
    """How fast the time of a trajectory passes, and how that changes.

    Args:
        target: The factor to reach, 0 to 1.
        ramp_time: How long a change from 0 to 1 takes [s], >= 0.

    Attributes:
        target: As given.
        factor: Time of the trajectory that passes per real time.
        rate: Rate at which the factor changes [1/s].
    """

    def __init__(self, target: float, ramp_time: float) -> None:
        self.target = target
        self.ramp_time = ramp_time
        self.factor = target
        self.rate = 0.0

    def advance(self, period: float) -> float:
        """Move the factor towards its target; return the trajectory time passed [s].

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        before = self.factor
        if before == self.target:
            self.rate = 0.0
            return period * before
        step = period / self.ramp_time if self.ramp_time > 0.0 else 1.0
        difference = self.target - before
        if abs(difference) <= step:
            self.factor = self.target
        else:
            self.factor = before + (step if difference > 0.0 else -step)
        self.rate = (self.factor - before) / period if period > 0.0 else 0.0
        return period * 0.5 * (before + self.factor)


class TrajectoryTime:
    """The time of a trajectory, and the splines that are followed at it.

    A subclass knows the trajectory. Times of trajectories are in whole nanoseconds, so
    that sums of times compare exactly.

    Args:
        speed: How fast the time passes.
        splines: Computes desired states and errors.

    Attributes:
        speed: As given.
        moment: Station time [s], time since the cycle before [s], and trajectory time
            [ns]: the integral of the speed over real time. One object, replaced as a
            whole, so that any thread may read it.
        sampled: Trajectory time of the states that were sampled last [s].
        load_time: When the next segments have to be loaded [s].
        path_end: When the first of the loaded segments ends [s].
        begin: When the first joint's segment begins [s].
        rests: Whether all joints rest at the ends of their last segments.
        times_from_start: Start of the first joint's segment, and the present time, both
            from the start of the trajectory [s], shape (2,); always the same memory.
    """

    def __init__(self, speed: SpeedFactor, splines: SplineGroup) -> None:
        self.speed = speed
        self.splines = splines
        self.moment: tuple[float, float, int] = (0.0, 0.0, 0)
        self.uptime = 0
        # The trajectory time that passes per cycle [s, ns].
        self.passed = 0.0
        self.passed_ns = 0
        self.sampled = 0.0
        self.load_time = -_INF
        self.path_end = -_INF
        self.begin = 0.0
        self.rests = False
        self.times_from_start = zeros(2)
        self.times = self.times_from_start

    def load(self, now: float) -> None:
        """Load the splines that are followed from `now` [s] until `load_time`."""
        raise NotImplementedError

    def set_moment(self, time: float, period: float, uptime: int) -> None:
        """Set the present moment; see `moment`."""
        self.uptime = uptime
        self.moment = (time, period, uptime)

    def pass_time(self, time: float, period: float) -> float:
        """Let the time of a cycle pass; return the trajectory time [s].

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.
        """
        passed = self.speed.advance(period)
        if passed != self.passed:
            self.passed = passed
            self.passed_ns = to_nanoseconds(passed)
        self.set_moment(time, period, self.uptime + self.passed_ns)
        return uptime_seconds(self.uptime)

    def sample(self, now: float) -> bool:
        """Compute desired states and errors; return whether one may be too large.

        Args:
            now: Trajectory time [s].
        """
        if now >= self.load_time:
            self.load(now)
        self.times[1] = now - self.begin + self.times[0]
        self.sampled = now
        if self.rests:
            self.splines.compare()
            return True
        found = self.splines.follow(now, self.speed.factor, self.speed.rate)
        if found & 1:  # IS_OVER
            self.rests = self.load_time == _INF
        return found >= 2  # EXCEEDS


class FeedForwardPidLaw(CommandLaw):
    """Commands what PIDs compute, and desired rates times gains.

    Args:
        pids: One PID per joint; their errors and rates are known.
        rates: Desired rates, shape (n,).
        gains: Gains of the rates, shape (n,).
    """

    def __init__(self, pids: PidGroup, rates: Doubles, gains: Doubles) -> None:
        self.pids = pids
        self.rates = rates
        self.gains = gains
        self.feeds_forward = any(gains)

    def compute_commands(self, period: float) -> None:
        """Compute the commands."""
        self.pids.compute_commands(period, rates_known=True)
        if self.feeds_forward:
            self.pids.add_feed_forward(self.rates, self.gains)


class TrajectoryUpdate(UsualUpdate):
    """Commands the joints along a trajectory that ends no goal.

    Args:
        execution: The trajectory.
        requests: What waits to be followed instead; empty in a usual cycle.
        supervision: Its `goal` is None in a usual cycle.
        law: Computes the commands.
        sampled: Keeps what was done.
    """

    def __init__(
        self,
        execution: TrajectoryTime,
        requests: Sized,
        supervision: Any,  # noqa: ANN401 - only its goal matters here
        law: CommandLaw,
        sampled: SampleColumns,
    ) -> None:
        self.execution = execution
        self.requests = requests
        self.supervision = supervision
        self.law = law
        self.sampled = sampled

    def run(self, time: float, period: float) -> bool:
        """Follow the trajectory unless something waits or a goal is watched."""
        if len(self.requests) or self.supervision.goal is not None:
            return False
        self.execution.sample(self.execution.pass_time(time, period))
        self.law.compute_commands(period)
        self.sampled.keep(time)
        return True
