"""Poses for the cycles of the arm in which a slow or late loop has none of its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

from station.core.numerics.rigid_motion import displace, twist_between
from station.hw.franka.commands.rate_limiter import PERIOD

FASTEST_RETURN = 25.0
"""Of the arm to the commanded poses, as a critically damped third order [1/s]."""
# Accelerations of a return that the joints can follow: of the translation [m/s^2], of
# the rotation [rad/s^2], and of the elbow [rad/s^2].
_SCALES = (1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 2.0)
# Peak acceleration of a return at rate k that begins x away: _FROM_OFFSET k^2 x; one
# that begins with v too fast: _FROM_RATE k v. Maxima of the closed forms.
_FROM_OFFSET, _FROM_RATE = 0.23, 0.80
_NEGLIGIBLE = 1e-12


@dataclass(frozen=True, slots=True)
class _Command:
    """A pose and an elbow, and in which cycle of the arm they were commanded."""

    pose: list[float]
    elbow: list[float]
    cycle: int

    def way_to(self, other: "_Command") -> list[float]:
        """Return twist and elbow that lead to another command, shape (7,)."""
        way = twist_between(self.pose, other.pose, 1.0)
        # Elbows of different signs, or none, are not apart.
        same = self.elbow[1:] == other.elbow[1:]
        return [*way, other.elbow[0] - self.elbow[0] if same and self.elbow else 0.0]

    def moved(self, way: Sequence[float], cycles: int) -> "_Command":
        """Return what is commanded some cycles later and some way on."""
        pose, elbow = self.pose, self.elbow
        bent = [elbow[0] + way[6], elbow[1]] if elbow and elbow[1] else elbow
        shifted = displace(pose, way[:3], way[3:6])
        return _Command(shifted, bent, self.cycle + cycles)


class PoseBridge:
    """Lets poses go on between two commands, and returns to the commands smoothly.

    The arm takes a pose in each of its own cycles. One that stands still for some of
    them, or that jumps by the way of several, breaks the limits of the joints: those of
    the end effector, which the commands are kept to, allow much more. What is sent is
    the course of the commands and an offset. Whenever a command is not where, or not as
    fast or as accelerated as, the course was thought to be, the course leaps and the
    offset leaps back; then it fades. Poses of a loop that is as fast as the arm pass
    unchanged. Control thread only.
    """

    def __init__(self) -> None:
        self.begin([], [])

    def begin(self, pose: Sequence[float], elbow: Sequence[float]) -> None:
        """Rest at a pose, 16 numbers, and an elbow, 2 numbers."""
        rest = [_Command(list(pose), list(elbow), cycle) for cycle in (-2, -1, 0)]
        # The last three commands, the newest last.
        self._before, self._earlier, self._last = rest
        self._cycle = 0
        # Change and second change of the course per cycle, as far as it was estimated.
        self._step, self._bend = [0.0] * 7, [0.0] * 7
        self._offset, self._rate, self._rise = [0.0] * 7, [0.0] * 7, [0.0] * 7
        self._gain = FASTEST_RETURN * PERIOD
        self._is_on_commands = True

    def pass_on(
        self, pose: Sequence[float], elbow: Sequence[float]
    ) -> tuple[list[float], list[float]]:
        """Return what to send for a new command.

        Args:
            pose: The commanded pose, 16 numbers.
            elbow: Position of joint 3 [rad] and sign of joint 4, or zeros, shape (2,).
        """
        self._cycle += 1
        command = _Command(list(pose), list(elbow), self._cycle)
        is_known = self._cycle - self._before.cycle == 3  # one command in each cycle
        expected = None if is_known else self._expected()
        self._before, self._earlier, self._last = self._earlier, self._last, command
        if not self._is_on_commands:
            self._fade()
        if expected is not None:
            step, bend = self._step, self._bend
            self._estimate()
            self._leap(command.way_to(expected), step, bend)
        return self._sent(command)

    def bridge(self) -> tuple[list[float], list[float]]:
        """Return what to send in a cycle of the arm without a command."""
        if self._cycle == self._last.cycle:
            self._estimate()
            # The course goes on at its speed; what accelerates it fades.
            bend, self._bend = self._bend, [0.0] * 7
            self._leap([0.0] * 7, self._step, bend)
        self._cycle += 1
        if not self._is_on_commands:
            self._fade()
        return self._sent(self._expected())

    def _expected(self) -> _Command:
        """Return where the course was thought to be in this cycle; move it on."""
        if self._bend_counts():
            self._step = [v + a for v, a in zip(self._step, self._bend, strict=True)]
        cycles = self._cycle - self._last.cycle
        return self._last.moved([cycles * value for value in self._step], cycles)

    def _bend_counts(self) -> bool:
        return self._cycle - self._last.cycle == 1 and any(self._bend)

    def _estimate(self) -> None:
        """Work out how the course goes on from its last three commands."""
        first = self._earlier.cycle - self._before.cycle
        second = self._last.cycle - self._earlier.cycle
        before = self._before.way_to(self._earlier)
        now = self._earlier.way_to(self._last)
        # The mean of a longer step is the speed in its middle.
        self._bend = [
            2.0 * (v / second - u / first) / (first + second)
            for u, v in zip(before, now, strict=True)
        ]
        self._step = [
            v / second + 0.5 * (second - 1) * change
            for v, change in zip(now, self._bend, strict=True)
        ]

    def _leap(
        self, way: Sequence[float], step: Sequence[float], bend: Sequence[float]
    ) -> None:
        """Keep what is sent going as it goes, when the course leaps.

        Args:
            way: From the new course to the old one, shape (7,).
            step: Change of the old one per cycle, shape (7,).
            bend: Second change of the old one per cycle, shape (7,).
        """
        for i in range(7):
            self._offset[i] += way[i]
            self._rate[i] += step[i] - self._step[i]
            self._rise[i] += bend[i] - self._bend[i]
        self._gain = _rate_of_return(self._offset, self._rate) * PERIOD
        self._is_on_commands = False

    def _fade(self) -> None:
        """Move the offset on by a cycle; nothing is left of it some time."""
        k = self._gain
        for i in range(7):
            x, v, a = self._offset[i], self._rate[i], self._rise[i]
            a -= k * (k * (k * x + 3.0 * v) + 3.0 * a)
            v += a
            self._offset[i], self._rate[i], self._rise[i] = x + v, v, a
        if max(map(abs, (*self._offset, *self._rate, *self._rise))) < _NEGLIGIBLE:
            self._offset, self._rate, self._rise = [0.0] * 7, [0.0] * 7, [0.0] * 7
            self._is_on_commands = True

    def _sent(self, course: _Command) -> tuple[list[float], list[float]]:
        if not self._is_on_commands:
            course = course.moved(self._offset, 0)
        return course.pose, course.elbow


def _rate_of_return(offset: Sequence[float], rate: Sequence[float]) -> float:
    """Return the rate with which no acceleration is above its scale [1/s].

    Args:
        offset: In m and rad, shape (7,).
        rate: Its change per cycle of the arm, shape (7,).
    """
    x, v = (
        max(abs(value) / scale for value, scale in zip(values, _SCALES, strict=True))
        for values in (offset, rate)
    )
    x, v = _FROM_OFFSET * x, _FROM_RATE * v / PERIOD
    # The positive solution of x k^2 + v k = 1.
    k = 2.0 / (v + sqrt(v * v + 4.0 * x)) if x or v else FASTEST_RETURN
    return min(FASTEST_RETURN, k)
