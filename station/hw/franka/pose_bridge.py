"""Poses for the cycles of the arm in which a slow or late loop has none of its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

from station.core.rigid_motion import displace, twist_between
from station.hw.franka.rate_limiter import PERIOD

FASTEST_RETURN = 15.0
"""Of the arm to the commanded poses, as a critically damped spring [1/s]."""
# Accelerations of a return that the joints can follow: of the translation [m/s^2], of
# the rotation [rad/s^2], and of the elbow [rad/s^2].
_SCALES = (1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 2.0)
_NEGLIGIBLE = 1e-9
_ZEROS = [0.0] * 7


@dataclass(slots=True)
class _Step:
    """A command and the one before it, `cycles` of the arm earlier."""

    earlier: tuple[list[float], list[float]]
    last: tuple[list[float], list[float]]
    cycles: int = 1

    def motion(self) -> list[float]:
        """Return twist and elbow of one cycle of the arm, shape (7,)."""
        (pose, elbow), (then, elbow_then) = self.last, self.earlier
        way = [*twist_between(then, pose, 1.0), _difference(elbow, elbow_then)]
        return [value / self.cycles for value in way]

    def predict(self, cycles: int) -> tuple[list[float], list[float]]:
        """Return the command after some more cycles if the motion goes on."""
        way = [cycles * value for value in self.motion()]
        return _moved(self.last, way)


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
        start = (list(pose), list(elbow))
        self._followed = _Step(start, start)
        self._since = 0  # cycles of the arm since the last command that was followed
        # The first command after a gap: how fast the motion is now, the next one tells.
        self._noted: tuple[list[float], list[float]] | None = None
        self._noted_at = 0
        # What is added to the commands, a twist and the elbow, and its rate.
        self._offset, self._rate = list(_ZEROS), list(_ZEROS)
        self._return_rate = FASTEST_RETURN
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
        if self._since and self._noted is None:
            self._noted, self._noted_at = command, self._since + 1
            return self.bridge()
        if self._noted is not None:
            cycles = self._since + 1 - self._noted_at
            self._return_to(_Step(self._noted, command, cycles))
        else:
            self._followed = _Step(self._followed.last, command)
        return self._displaced(command)

    def bridge(self) -> tuple[list[float], list[float]]:
        """Return what to send in a cycle of the arm without a command."""
        self._since += 1
        return self._displaced(self._followed.predict(self._since))

    def _return_to(self, step: _Step) -> None:
        """Follow the commands again, beginning where and as fast as the arm is."""
        expected, elbow = _moved(self._followed.predict(self._since + 1), self._offset)
        self._offset = [
            *twist_between(step.last[0], expected, 1.0),
            _difference(elbow, step.last[1]),
        ]
        self._rate = [
            rate + (before - now) / PERIOD
            for rate, before, now in zip(
                self._rate, self._followed.motion(), step.motion(), strict=True
            )
        ]
        self._return_rate = _rate_of_return(self._offset, self._rate)
        self._is_on_commands = False
        self._followed, self._since, self._noted = step, 0, None

    def _displaced(
        self, command: tuple[list[float], list[float]]
    ) -> tuple[list[float], list[float]]:
        if self._is_on_commands:
            return command
        offset, stiffness = self._offset, self._return_rate
        result = _moved(command, offset)
        for i, (x, v) in enumerate(zip(offset, self._rate, strict=True)):
            self._rate[i] = v - stiffness * (stiffness * x + 2.0 * v) * PERIOD
            offset[i] = x + self._rate[i] * PERIOD
        if max(map(abs, (*offset, *self._rate))) < _NEGLIGIBLE:
            self._offset, self._rate = list(_ZEROS), list(_ZEROS)
            self._is_on_commands = True
        return result


def _rate_of_return(offset: Sequence[float], rate: Sequence[float]) -> float:
    """Return the spring's rate with which no acceleration is above its scale [1/s]."""
    x, v = (
        max(abs(value) / scale for value, scale in zip(values, _SCALES, strict=True))
        for values in (offset, rate)
    )
    # The positive solution of rate^2 x + 2 rate v = 1.
    return min(FASTEST_RETURN, 1.0 / (v + sqrt(v * v + x))) if x or v else 0.0


def _moved(
    command: tuple[list[float], list[float]], way: Sequence[float]
) -> tuple[list[float], list[float]]:
    pose, elbow = command
    bent = [elbow[0] + way[6], elbow[1]] if elbow[1] else list(elbow)
    return displace(pose, way[:3], way[3:6]), bent


def _difference(elbow: Sequence[float], other: Sequence[float]) -> float:
    """Return how far two elbows are apart; 0 when one of them is none."""
    return elbow[0] - other[0] if elbow[1] == other[1] else 0.0
