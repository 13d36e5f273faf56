"""How a commanded pose moves, to go on when the client's next one is late."""

from collections.abc import Sequence
from math import exp, sqrt

from station.core.rigid_motion import displace, twist_between
from station.hw.franka.arm_limits import MotionLimits

RETURN_RATE = 10.0
"""How fast the goal comes back to the client's poses after a gap [1/s]."""
SMOOTHING = 0.2
"""Share of a new acceleration that counts: what follows a gap is uncertain."""
# What is left of a gap when it counts as closed [m, rad].
_CLOSED = 1e-10


class PoseGoal:
    """Continues a sequence of poses with constant acceleration.

    When the client is back, the difference between what it commands and where the goal
    has gone fades away: a step of some micrometres within a cycle is more than the
    joints may do. Poses that jump, so that no arm could follow them, are passed on as
    they are. Control thread only.

    Args:
        translation: What counts as smooth.
        rotation: The same for the orientation.
        cycle_time: Duration of a cycle of the arm [s].
    """

    def __init__(
        self, translation: MotionLimits, rotation: MotionLimits, cycle_time: float
    ) -> None:
        self._limits = (translation, rotation)
        self._cycle_time = cycle_time
        self.begin(())

    def begin(self, pose: Sequence[float]) -> None:
        """Begin at rest.

        Args:
            pose: Where, 16 numbers.
        """
        self._pose = list(pose)
        self._period = self._cycle_time
        self._mean = [0.0] * 6  # the client's twist over the last period
        self._twist = [0.0] * 6  # the same at its end
        self._rate = [0.0] * 6
        self._goal = self._pose
        self._goal_twist = self._twist
        self._late = 0  # cycles without a command
        self._is_unsure = False  # whether `_twist` is only assumed
        self._gap: list[float] = []
        self._gap_rate = [0.0] * 6

    def note(self, pose: Sequence[float], period: float) -> list[float]:
        """Take over what the client commands; return the goal of this cycle.

        Args:
            pose: 16 numbers.
            period: Time since the command before [s]; nothing is learnt when it is 0.
        """
        late, self._late = self._late, 0
        continued = self._continued() if late else []
        if round(period / self._cycle_time) == late + 1:
            self._learn(pose, period)
        elif late:
            # Some time was lost: the client is taken to be as fast as the goal is.
            self._twist = self._goal_twist
            self._is_unsure = True
        self._pose = list(pose)
        if not self._is_smooth():
            self._gap = []
        elif late:
            self._gap = twist_between(pose, continued, 1.0)
            self._gap_rate = _difference(self._goal_twist, self._twist)
        self._goal, self._goal_twist = self._pose, self._twist
        if self._gap:
            self._fade(self._cycle_time)
        return self._goal

    def go_on(self) -> list[float]:
        """Return the goal of a cycle in which the client commands nothing."""
        self._late += 1
        return self._continued()

    def _continued(self) -> list[float]:
        if self._is_smooth():
            period = self._cycle_time
            step = [
                (v + a * period / 2.0) * period
                for v, a in zip(self._goal_twist, self._rate, strict=True)
            ]
            self._goal_twist = [
                v + a * period
                for v, a in zip(self._goal_twist, self._rate, strict=True)
            ]
            self._goal = displace(self._goal, step[:3], step[3:])
        return self._goal

    def _learn(self, pose: Sequence[float], period: float) -> None:
        mean = twist_between(self._pose, pose, period)
        assumed = [v + a * period for v, a in zip(self._twist, self._rate, strict=True)]
        # A mean is the velocity in the middle of its period.
        apart = (period + self._period) / 2.0
        if not self._is_unsure:
            self._rate = [
                old_rate + SMOOTHING * ((new - old) / apart - old_rate)
                for new, old, old_rate in zip(mean, self._mean, self._rate, strict=True)
            ]
        self._twist = [
            v + a * period / 2.0 for v, a in zip(mean, self._rate, strict=True)
        ]
        if self._is_unsure:
            self._gap = self._gap or [0.0] * 6
            wrong = _difference(assumed, self._twist)
            self._gap_rate = [a + b for a, b in zip(self._gap_rate, wrong, strict=True)]
            self._is_unsure = False
        self._mean, self._period = mean, period

    def _fade(self, period: float) -> None:
        """Let the gap fade, critically damped, and put the goal that far away."""
        fading = exp(-RETURN_RATE * period)
        slope = [
            rate + RETURN_RATE * away
            for rate, away in zip(self._gap_rate, self._gap, strict=True)
        ]
        self._gap = [
            (away + s * period) * fading
            for away, s in zip(self._gap, slope, strict=True)
        ]
        self._gap_rate = [
            (rate - RETURN_RATE * s * period) * fading
            for rate, s in zip(self._gap_rate, slope, strict=True)
        ]
        self._goal = displace(self._pose, self._gap[:3], self._gap[3:])
        self._goal_twist = [
            a + b for a, b in zip(self._twist, self._gap_rate, strict=True)
        ]
        if max(map(abs, self._gap)) < _CLOSED:
            self._gap = []

    def _is_smooth(self) -> bool:
        for part, limits in zip((slice(0, 3), slice(3, 6)), self._limits, strict=True):
            if (
                _norm(self._twist[part]) > limits.velocity
                or _norm(self._rate[part]) > limits.acceleration
            ):
                return False
        return True


def _difference(first: Sequence[float], second: Sequence[float]) -> list[float]:
    return [a - b for a, b in zip(first, second, strict=True)]


def _norm(vector: Sequence[float]) -> float:
    return sqrt(sum(value * value for value in vector))
