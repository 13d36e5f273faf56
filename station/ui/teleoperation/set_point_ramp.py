"""Elements of a set-point that travel to their targets at a limited speed.

A set-point follows what the controller was told last until a person moves an element.
Then that element travels to its target at a limited speed, so that a far value is no
step for the robot. After anything unexpected (a stop, another controller, a refusal)
no more set-points are sent.
"""

from collections.abc import Iterable, Sequence

from station.ui.link.station_view import POSITION_UNITS
from station.wire import CommandElement

HOLD = 1.0
"""Time for which a released slider keeps its value before it follows the robot [s]."""


class Movers:
    """Who moves each joint now: of two people, the one who asked last. Any thread."""

    def __init__(self) -> None:
        self._of: dict[str, object] = {}

    def take(self, element: str, mover: object) -> None:
        """Let `mover` move an element from now on, and nobody else."""
        self._of[element] = mover

    def has_lost(self, element: str, mover: object) -> bool:
        """Return whether somebody else has taken an element that `mover` took."""
        return self._of.get(element) is not mover


class SetPointRamp:
    """Elements of a set-point that travel from where they are to the wanted values.

    It decides about the elements that it moves and about no other: somebody else may
    move those meanwhile.

    Args:
        elements: The numbers of the set-point. The speed of positions is limited; other
            quantities are sent as they are.
        movers: Shared by all that may command the same elements.
    """

    def __init__(
        self, elements: Sequence[CommandElement], movers: Movers | None = None
    ) -> None:
        self._names = [element.name for element in elements]
        self._limited = [element.unit in POSITION_UNITS for element in elements]
        self._movers = Movers() if movers is None else movers
        self._told: list[float] | None = None
        self._targets: dict[int, float] = {}
        self._current: dict[int, float] = {}
        self._unconfirmed: set[int] = set()
        self._sent: set[int] = set()  # those of them that the last step had
        self._touched_at: dict[int, float] = {}

    @property
    def commanding(self) -> bool:
        """Whether an element has not reached its wanted value yet."""
        return bool(self._targets)

    @property
    def is_known(self) -> bool:
        """Whether the last set-point of the controller is known."""
        return self._told is not None

    @property
    def remaining(self) -> float:
        """Largest remaining distance of an element with limited speed [rad] or [m]."""
        away = (abs(end - self._current[i]) for i, end in self._targets.items())
        return max(away, default=0.0)

    def follow(self, set_point: Sequence[float]) -> None:
        """Note the last set-point of the controller, from which elements start.

        Args:
            set_point: One number per element, in their units.
        """
        self._told = list(set_point)

    def present(self, index: int) -> float | None:
        """Return what an element is told now; None while that is not known."""
        told = None if self._told is None else self._told[index]
        return self._current.get(index, told)

    def touch(self, index: int, value: float, now: float) -> bool:
        """Set the target of one element.

        Args:
            index: Index of the element.
            value: The wanted value, in the unit of the element.
            now: Monotonic time [s].

        Returns:
            False while the last set-point of the controller is not known.
        """
        start = self.present(index)
        if start is None:
            return False
        if index not in self._targets or self.has_lost(index):
            self._unconfirmed.add(index)
        self._current[index] = start
        self._targets[index] = value
        self._touched_at[index] = now
        return True

    def let_go(self) -> None:
        """Forget the targets; follow the robot again."""
        self.halt(list(self._targets))
        self._told = None
        self._touched_at.clear()

    def halt(self, indices: Iterable[int]) -> None:
        """Let elements stay at the last set-point; they are where they were told to be.

        Args:
            indices: Which of them.
        """
        for index in indices:
            if index in self._targets and self._told is not None:
                self._told[index] = self._current[index]
            self._forget(index)
            self._touched_at.pop(index, None)

    def confirm(self) -> None:
        """Note that the station took the last step: what it moves is moved from here.

        Before, nobody else's motion ends: the station may refuse this one.
        """
        for index in self._sent:
            self._movers.take(self._names[index], self)
        self._unconfirmed -= self._sent
        self._sent.clear()

    def give_up_lost(self) -> list[int]:
        """End the motion of the elements that somebody else has moved since.

        Returns:
            Their indices.
        """
        lost = [i for i in self._targets if self.has_lost(i)]
        for index in lost:
            self._forget(index)
        return lost

    def has_lost(self, index: int) -> bool:
        """Return whether somebody else has moved an element since it was touched."""
        is_confirmed = index in self._targets and index not in self._unconfirmed
        return is_confirmed and self._movers.has_lost(self._names[index], self)

    def step(self, dt: float, speed: float) -> list[float | None] | None:
        """Return the next set-point to send, or None when there is nothing to send.

        Args:
            dt: Time since the last step [s].
            speed: Fastest change of a position [rad/s] or [m/s], > 0.

        Returns:
            One number per element; None for those that are not moved from here.
        """
        if not self._targets:
            return None
        command: list[float | None] = [None] * len(self._names)
        self._sent = set(self._unconfirmed)
        reach = speed * dt
        for i, target in list(self._targets.items()):
            away = target - self._current[i]
            if self._limited[i] and abs(away) > reach:
                self._current[i] += reach if away > 0.0 else -reach
            else:
                self._current[i] = target
            command[i] = self._current[i]
            if self._current[i] == target:
                self._arrive(i)
        return command

    def shown(self, index: int, now: float) -> float | None:
        """Return what slider `index` should show, or None to leave it as it is."""
        if now - self._touched_at.get(index, float("-inf")) < HOLD:
            return None
        told = None if self._told is None else self._told[index]
        return self._targets.get(index, told)

    def _arrive(self, index: int) -> None:
        """End the motion of an element that has reached its target."""
        if self._told is not None:
            self._told[index] = self._current[index]
        del self._targets[index], self._current[index]

    def _forget(self, index: int) -> None:
        self._targets.pop(index, None)
        self._current.pop(index, None)
        self._unconfirmed.discard(index)
