"""How a commanded pose moves, to go on when the client's next one is late."""

from collections.abc import Sequence
from math import sqrt

from station.core.rigid_motion import displace, twist_between
from station.hw.franka.arm_limits import MotionLimits


class PoseGoal:
    """Continues a sequence of poses with constant acceleration.

    Poses that jump, so that no arm could follow them, are not continued: the last one
    stays the goal. Control thread only.

    Args:
        translation: What counts as smooth.
        rotation: The same for the orientation.
    """

    def __init__(self, translation: MotionLimits, rotation: MotionLimits) -> None:
        self._limits = (translation, rotation)
        self._pose: Sequence[float] = ()
        self._goal: list[float] = []
        self._twist = [0.0] * 6
        self._rate = [0.0] * 6

    def begin(self, pose: Sequence[float]) -> None:
        """Begin at rest.

        Args:
            pose: Where, 16 numbers.
        """
        self._pose, self._goal = list(pose), list(pose)
        self._twist, self._rate = [0.0] * 6, [0.0] * 6

    def note(self, pose: Sequence[float], period: float) -> None:
        """Take over what the client commands.

        Args:
            pose: 16 numbers.
            period: Time since the command before [s]; nothing is learnt when it is 0.
        """
        if period > 0.0:
            twist = twist_between(self._pose, pose, period)
            self._rate = [
                (new - old) / period
                for new, old in zip(twist, self._twist, strict=True)
            ]
            self._twist = twist
        self._pose, self._goal = list(pose), list(pose)

    def go_on(self, period: float) -> list[float]:
        """Return the pose of a cycle in which the client commands nothing.

        Args:
            period: Duration of the cycle [s].
        """
        if not self._is_smooth():
            return self._goal
        self._twist = [
            v + a * period for v, a in zip(self._twist, self._rate, strict=True)
        ]
        step = [v * period for v in self._twist]
        self._goal = displace(self._goal, step[:3], step[3:])
        return self._goal

    def _is_smooth(self) -> bool:
        for part, limits in zip((slice(0, 3), slice(3, 6)), self._limits, strict=True):
            if (
                _norm(self._twist[part]) > limits.velocity
                or _norm(self._rate[part]) > limits.acceleration
            ):
                return False
        return True


def _norm(vector: Sequence[float]) -> float:
    return sqrt(sum(value * value for value in vector))
