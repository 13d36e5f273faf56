"""Predict poses for the arm cycles in which a slow or late loop commands no pose."""

from collections.abc import Sequence
from math import sqrt

from station.core.numerics.rigid_motion import displace, twist_between
from station.memory.doubles import Doubles, doubles, put, zeros
from station.memory.vectors import copy_into, differ

_POSE = 16
_ELBOW = 2
_KEPT = 3
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


class _Command:
    """A pose and an elbow, and the arm cycle in which they were commanded."""

    def __init__(self, pose: Doubles, elbow: Sequence[float], cycle: int) -> None:
        self.pose = pose
        self.elbow = elbow
        self.cycle = cycle

    def way_to(self, other: "_Command") -> list[float]:
        """Return twist and elbow that lead to another command, shape (7,)."""
        way = zeros(6)
        twist_between(self.pose, other.pose, 1.0, way)
        # Elbows of different signs have no distance.
        same = self.elbow[1] == other.elbow[1]
        return [*way, other.elbow[0] - self.elbow[0] if same else 0.0]

    def moved(self, way: Sequence[float], cycles: int) -> "_Command":
        """Return the command of a later cycle, moved by a twist and an elbow."""
        elbow, pose = self.elbow, zeros(_POSE)
        bent = [elbow[0] + way[6], elbow[1]] if elbow[1] else elbow
        displace(self.pose, doubles(way[:6]), 1.0, pose)
        return _Command(pose, bent, self.cycle + cycles)


class PoseBridge:
    """Extrapolates poses between two commands, and returns to the commands smoothly.

    The arm takes a pose in each of its own cycles. A pose that stands still for some
    cycles, or jumps by the distance of several cycles, exceeds the limits of the
    joints; the limits of the end effector, which the commands obey, allow much more.

    The pose that is sent is the sum of a prediction of the commands and an offset. When
    a command differs from its prediction in position, velocity or acceleration, the
    prediction jumps to the command and the offset jumps back by as much, so that the
    sum stays continuous; then the offset decays. With a loop as fast as the arm, poses
    pass unchanged: each is noted, and nothing else is done. Control thread only.

    Args:
        period: Duration of a cycle of the arm [s], > 0.

    Attributes:
        is_on_commands: Whether the sent poses equal the commanded ones.
        pose: The pose to send otherwise, 16 numbers.
        elbow: The elbow to send otherwise, shape (2,).
    """

    def __init__(self, period: float) -> None:
        self.period = period
        # The last three commands, and the cycles of the last, the one before it, and
        # the one before that.
        self.poses = zeros(_KEPT * _POSE)
        self.elbows = zeros(_KEPT * _ELBOW)
        self.newest = 0
        self.cycle = 0
        self.last_cycle, self.earlier_cycle, self.before_cycle = 0, -1, -2
        self.is_on_commands = True
        self.pose = zeros(_POSE)
        self.elbow = zeros(_ELBOW)
        self.rest_at([0.0] * _POSE, [0.0] * _ELBOW)

    def rest_at(self, pose: Sequence[float], elbow: Sequence[float]) -> None:
        """Rest at a pose, 16 numbers, and an elbow, 2 numbers."""
        # As if the pose had been commanded three times: velocity and acceleration of
        # the prediction are then 0.
        for self.cycle in (-3, -2, -1):
            self.note_next(doubles(pose), doubles(elbow))
        # First and second difference of the prediction per cycle.
        self._step, self._bend = [0.0] * 7, [0.0] * 7
        self._offset, self._rate, self._rise = [0.0] * 7, [0.0] * 7, [0.0] * 7
        self._gain = FASTEST_RETURN * self.period
        self.is_on_commands = True

    def is_expected(self) -> bool:
        """Return whether a command now follows one of each of the last two cycles.

        Such a command is to be noted and sent as it is.
        """
        return self.is_on_commands and self.cycle == self.before_cycle + 2

    def note_next(self, pose: Doubles, elbow: Doubles) -> None:
        """Note the command of the next cycle: 16 numbers, and 2 of its elbow."""
        self.cycle += 1
        newest = self.newest + 1
        if newest == _KEPT:
            newest = 0
        self.newest = newest
        copy_into(self.poses, _POSE * newest, pose, _POSE)
        copy_into(self.elbows, _ELBOW * newest, elbow, _ELBOW)
        self.before_cycle, self.earlier_cycle = self.earlier_cycle, self.last_cycle
        self.last_cycle = self.cycle

    def repeats(self, pose: Doubles) -> bool:
        """Return whether a pose equals the last noted one."""
        start = _POSE * self.newest
        return not differ(self.poses[start : start + _POSE], pose, _POSE)

    def pass_on(self, pose: Doubles, elbow: Doubles) -> None:
        """Note a command, and compute the pose to send for it.

        Args:
            pose: The commanded pose, 16 numbers.
            elbow: Position of joint 3 [rad] and sign of joint 4, or zeros, shape (2,).
        """
        is_regular = self.cycle == self.before_cycle + 2  # one command in each cycle
        expected = None if is_regular else self._expected(self.cycle + 1)
        self.note_next(pose, elbow)
        command = self._command(0)
        if not self.is_on_commands:
            self._fade()
        if expected is not None:
            step, bend = self._step, self._bend
            self._estimate()
            self._leap(command.way_to(expected), step, bend)
        self._send(command)

    def predict(self) -> None:
        """Compute the pose to send in an arm cycle without a command."""
        if self.cycle == self.last_cycle:
            self._estimate()
            # The prediction keeps its velocity; its acceleration decays in the offset.
            bend, self._bend = self._bend, [0.0] * 7
            self._leap([0.0] * 7, self._step, bend)
        self.cycle += 1
        if not self.is_on_commands:
            self._fade()
        self._send(self._expected(self.cycle))

    def _command(self, age: int) -> _Command:
        """Return the last command, or the one that was noted `age` commands before."""
        cycles = (self.last_cycle, self.earlier_cycle, self.before_cycle)
        place = (self.newest - age) % _KEPT
        pose = self.poses[_POSE * place : _POSE * place + _POSE]
        elbow = self.elbows[_ELBOW * place : _ELBOW * place + _ELBOW]
        return _Command(doubles(pose), list(elbow), cycles[age])

    def _expected(self, cycle: int) -> _Command:
        """Advance the prediction to a cycle, the next one, and return it."""
        cycles = cycle - self.last_cycle
        if cycles == 1 and any(self._bend):
            self._step = [v + a for v, a in zip(self._step, self._bend, strict=True)]
        return self._command(0).moved([cycles * value for value in self._step], cycles)

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
        rate = _rate_of_return(self._offset, self._rate, self.period)
        self._gain = rate * self.period
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

    def _send(self, course: _Command) -> None:
        if not self.is_on_commands:
            course = course.moved(self._offset, 0)
        put(self.pose, course.pose)
        put(self.elbow, course.elbow)


def _rate_of_return(
    offset: Sequence[float], rate: Sequence[float], period: float
) -> float:
    """Return the decay rate with which no acceleration exceeds its scale [1/s].

    Args:
        offset: In m and rad, shape (7,).
        rate: Its change per cycle of the arm, shape (7,).
        period: Duration of the cycle [s].
    """
    x, v = (
        max(abs(value) / scale for value, scale in zip(values, _SCALES, strict=True))
        for values in (offset, rate)
    )
    x, v = _FROM_OFFSET * x, _FROM_RATE * v / period
    # The positive solution of x k^2 + v k = 1.
    k = 2.0 / (v + sqrt(v * v + 4.0 * x)) if x or v else FASTEST_RETURN
    return min(FASTEST_RETURN, k)
