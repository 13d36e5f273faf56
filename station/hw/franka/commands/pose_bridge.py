"""Predict poses for the arm cycles in which a slow or late loop commands no pose."""

from collections.abc import Sequence
from math import sqrt
from typing import NamedTuple

from station.core.numerics.poses import displace, twist_between
from station.hw.franka.commands.pose_sending import PassedPoses
from station.hw.franka.commands.rate_limiter import PERIOD
from station.memory.doubles import doubles

FASTEST_RETURN = 25.0
"""Fastest decay rate of the offset between commanded and predicted poses [1/s]; the
offset decays as a critically damped system of third order."""
# Accelerations of the decaying offset that the joints can follow: translation [m/s^2],
# rotation [rad/s^2] and elbow [rad/s^2].
_SCALES = (1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 2.0)
# Peak acceleration of a decay at rate k: _FROM_OFFSET k^2 x for an initial offset x,
# _FROM_RATE k v for an initial rate v. Maxima of the closed forms.
_FROM_OFFSET, _FROM_RATE = 0.23, 0.80
_NEGLIGIBLE = 1e-12


class _Command(NamedTuple):
    """A pose and an elbow, and the arm cycle in which they were commanded."""

    pose: list[float]
    elbow: list[float]
    cycle: int

    def way_to(self, other: "_Command") -> list[float]:
        """Return twist and elbow that lead to another command, shape (7,)."""
        way = twist_between(self.pose, other.pose, 1.0)
        # Elbows of different signs have no distance.
        same = self.elbow[1] == other.elbow[1]
        return [*way, other.elbow[0] - self.elbow[0] if same else 0.0]

    def moved(self, way: Sequence[float], cycles: int) -> "_Command":
        """Return the command of a later cycle, moved by a twist and an elbow."""
        pose, elbow = self.pose, self.elbow
        bent = [elbow[0] + way[6], elbow[1]] if elbow[1] else elbow
        shifted = displace(pose, way[:3], way[3:6])
        return _Command(shifted, bent, self.cycle + cycles)


class PoseBridge(PassedPoses):
    """Extrapolates poses between two commands, and returns to the commands smoothly.

    The arm takes a pose in each of its own cycles. A pose that stands still for some
    cycles, or jumps by the distance of several cycles, exceeds the limits of the
    joints; the limits of the end effector, which the commands obey, allow much more.

    The pose that is sent is the sum of a prediction of the commands and an offset. When
    a command differs from its prediction in position, velocity or acceleration, the
    prediction jumps to the command and the offset jumps back by as much, so that the
    sum stays continuous; then the offset decays. With a loop as fast as the arm, poses
    pass unchanged. Control thread only.
    """

    def __init__(self) -> None:
        super().__init__()
        self.begin([0.0] * 16, [0.0] * 2)

    def begin(self, pose: Sequence[float], elbow: Sequence[float]) -> None:
        """Rest at a pose, 16 numbers, and an elbow, 2 numbers."""
        for self.cycle in (-2, -1, 0):
            self.note(doubles(pose), doubles(elbow))
        # First and second difference of the prediction per cycle.
        self._step, self._bend = [0.0] * 7, [0.0] * 7
        self._offset, self._rate, self._rise = [0.0] * 7, [0.0] * 7, [0.0] * 7
        self._gain = FASTEST_RETURN * PERIOD
        self.is_on_commands = True

    def pass_on(
        self, pose: Sequence[float], elbow: Sequence[float]
    ) -> tuple[Sequence[float], Sequence[float]]:
        """Return the pose and the elbow to send for a new command.

        In the usual case they are the arguments.

        Args:
            pose: The commanded pose, 16 numbers.
            elbow: Position of joint 3 [rad] and sign of joint 4, or zeros, shape (2,).
        """
        self.cycle += 1
        is_known = self.cycle - self.before_cycle == 3  # one command in each cycle
        expected = None if is_known else self._expected()
        self.note(doubles(pose), doubles(elbow))
        command = self._command(0)
        if not self.is_on_commands:
            self._fade()
        if expected is not None:
            step, bend = self._step, self._bend
            self._estimate()
            self._leap(command.way_to(expected), step, bend)
        return (pose, elbow) if self.is_on_commands else self._sent(command)

    def bridge(self) -> tuple[list[float], list[float]]:
        """Return the pose and the elbow to send in an arm cycle without a command."""
        if self.cycle == self.last_cycle:
            self._estimate()
            # The prediction keeps its velocity; its acceleration decays in the offset.
            bend, self._bend = self._bend, [0.0] * 7
            self._leap([0.0] * 7, self._step, bend)
        self.cycle += 1
        if not self.is_on_commands:
            self._fade()
        return self._sent(self._expected())

    def _command(self, age: int) -> _Command:
        """Return the last command, or the one that was noted `age` commands before."""
        cycles = (self.last_cycle, self.earlier_cycle, self.before_cycle)
        place = (self.newest - age) % len(cycles)
        pose = self.poses[16 * place : 16 * place + 16]
        elbow = self.elbows[2 * place : 2 * place + 2]
        return _Command([*pose], [*elbow], cycles[age])

    def _expected(self) -> _Command:
        """Advance the prediction by a cycle and return it."""
        if self._bend_counts():
            self._step = [v + a for v, a in zip(self._step, self._bend, strict=True)]
        cycles = self.cycle - self.last_cycle
        return self._command(0).moved([cycles * value for value in self._step], cycles)

    def _bend_counts(self) -> bool:
        return self.cycle - self.last_cycle == 1 and any(self._bend)

    def _estimate(self) -> None:
        """Estimate velocity and acceleration of the prediction from three commands."""
        last, earlier, before = (self._command(age) for age in range(3))
        first = earlier.cycle - before.cycle
        second = last.cycle - earlier.cycle
        older, newer = before.way_to(earlier), earlier.way_to(last)
        # The mean velocity of a longer step is the velocity in its middle.
        self._bend = [
            2.0 * (v / second - u / first) / (first + second)
            for u, v in zip(older, newer, strict=True)
        ]
        self._step = [
            v / second + 0.5 * (second - 1) * change
            for v, change in zip(newer, self._bend, strict=True)
        ]

    def _leap(
        self, way: Sequence[float], step: Sequence[float], bend: Sequence[float]
    ) -> None:
        """Change the offset so that the pose that is sent stays continuous.

        Args:
            way: From the new prediction to the old prediction, shape (7,).
            step: Change of the old one per cycle, shape (7,).
            bend: Second change of the old one per cycle, shape (7,).
        """
        for i in range(7):
            self._offset[i] += way[i]
            self._rate[i] += step[i] - self._step[i]
            self._rise[i] += bend[i] - self._bend[i]
        self._gain = _rate_of_return(self._offset, self._rate) * PERIOD
        self.is_on_commands = False

    def _fade(self) -> None:
        """Let the offset decay by a cycle; a negligible offset becomes zero."""
        k = self._gain
        for i in range(7):
            x, v, a = self._offset[i], self._rate[i], self._rise[i]
            a -= k * (k * (k * x + 3.0 * v) + 3.0 * a)
            v += a
            self._offset[i], self._rate[i], self._rise[i] = x + v, v, a
        if max(map(abs, (*self._offset, *self._rate, *self._rise))) < _NEGLIGIBLE:
            self._offset, self._rate, self._rise = [0.0] * 7, [0.0] * 7, [0.0] * 7
            self.is_on_commands = True

    def _sent(self, course: _Command) -> tuple[list[float], list[float]]:
        if not self.is_on_commands:
            course = course.moved(self._offset, 0)
        return course.pose, course.elbow


def _rate_of_return(offset: Sequence[float], rate: Sequence[float]) -> float:
    """Return the decay rate with which no acceleration exceeds its scale [1/s].

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
