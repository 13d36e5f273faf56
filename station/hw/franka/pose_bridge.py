"""Poses for the cycles of the arm in which a slow or late loop has none of its own."""

from collections.abc import Sequence

from station.hw.franka.rate_limiter import PERIOD
from station.hw.franka.rigid_motion import displace, twist_between

RATE = 15.0
"""How fast the arm returns to the commanded poses, as a critically damped spring [1/s].
Slow enough for the joints after the longest gap the arm makes up for, 20 cycles."""
_NEGLIGIBLE = 1e-9
_ZEROS = [0.0] * 7


class PoseBridge:
    """Lets poses go on between two commands, and returns to the commands smoothly.

    The arm takes a pose in each of its own cycles. One that stands still for some of
    them, or that jumps by the way of several, breaks the limits of the joints: those of
    the end effector, which the commands are kept to, allow much more. Poses of a loop
    that is as fast as the arm pass unchanged. Control thread only.
    """

    def __init__(self) -> None:
        self.begin([], [])

    def begin(self, pose: Sequence[float], elbow: Sequence[float]) -> None:
        """Rest at a pose, 16 numbers, and an elbow, 2 numbers."""
        self._last = self._earlier = (list(pose), list(elbow))
        # Cycles of the arm between those two, and since the last one.
        self._between, self._since = 1, 0
        # What is added to the commands, a twist and the elbow, and its rate.
        self._offset, self._rate = list(_ZEROS), list(_ZEROS)
        self._is_on_commands = True

    def pass_on(
        self, pose: Sequence[float], elbow: Sequence[float]
    ) -> tuple[list[float], list[float]]:
        """Return what to send for a new command.

        Args:
            pose: The commanded pose, 16 numbers.
            elbow: Position of joint 3 [rad] and sign of joint 4, or zeros, shape (2,).
        """
        command = (list(pose), list(elbow))
        if self._since:
            expected, expected_elbow = self._displaced(*self._predicted())
            self._offset = twist_between(command[0], expected, 1.0)
            self._offset.append(_difference(expected_elbow, command[1]))
            self._is_on_commands = False
        self._earlier, self._between = self._last, self._since + 1
        self._last, self._since = command, 0
        return self._displaced(*command)

    def bridge(self) -> tuple[list[float], list[float]]:
        """Return what to send in a cycle of the arm without a command."""
        predicted = self._predicted()
        self._since += 1
        return self._displaced(*predicted)

    def _predicted(self) -> tuple[list[float], list[float]]:
        """Return what the next command is if the motion goes on."""
        (earlier, earlier_elbow), (last, last_elbow) = self._earlier, self._last
        share = (self._since + 1) / self._between
        twist = [share * value for value in twist_between(earlier, last, 1.0)]
        elbow = list(last_elbow)
        elbow[0] += share * _difference(last_elbow, earlier_elbow)
        return displace(last, twist[:3], twist[3:]), elbow

    def _displaced(
        self, pose: list[float], elbow: list[float]
    ) -> tuple[list[float], list[float]]:
        if self._is_on_commands:
            return pose, elbow
        offset = self._offset
        result = displace(pose, offset[:3], offset[3:6])
        moved = [elbow[0] + offset[6], elbow[1]] if elbow[1] else elbow
        for i, (x, v) in enumerate(zip(offset, self._rate, strict=True)):
            acceleration = -RATE * (RATE * x + 2.0 * v)
            self._rate[i] = v + acceleration * PERIOD
            offset[i] = x + self._rate[i] * PERIOD
        if max(map(abs, (*offset, *self._rate))) < _NEGLIGIBLE:
            self._offset, self._rate = list(_ZEROS), list(_ZEROS)
            self._is_on_commands = True
        return result, moved


def _difference(elbow: Sequence[float], other: Sequence[float]) -> float:
    """Return how far two elbows are apart; 0 when one of them is none."""
    return elbow[0] - other[0] if elbow[1] == other[1] else 0.0
