"""Which controller the joint sliders command, and how fast a set-point may move.

The sliders follow the robot until somebody touches one. Then the touched element
travels to its target at a limited speed, so that a click at the far end of a slider is
no step for the robot. After anything unexpected (a stop, another controller, a
refusal) no more set-points are sent, and the sliders follow the robot again.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from station.ui.recovery_model import choose_rescue
from station.ui.station_view import StationView
from station.wire import CommandElement

HOLD = 1.0
"""Time for which a released slider keeps its value before it follows the robot [s]."""
POSITION_UNITS = frozenset({"rad", "m"})
_OF_THE_END_EFFECTOR = frozenset({"x", "vx"})


@dataclass(frozen=True, slots=True)
class Operated:
    """The controller that the sliders command.

    Attributes:
        name: Its name; empty when there is none.
        elements: The numbers of its set-point, in order.
        reason: Why the sliders are greyed; empty when they are not.
    """

    name: str = ""
    elements: tuple[CommandElement, ...] = ()
    reason: str = ""


def is_of_hand(elements: Sequence[CommandElement]) -> bool:
    """Return whether a set-point is a pose or a velocity of an end effector."""
    return bool(elements) and elements[0].name in _OF_THE_END_EFFECTOR


def is_of_joints(elements: Sequence[CommandElement]) -> bool:
    """Return whether a set-point has one number per joint."""
    return bool(elements) and not is_of_hand(elements)


def choose_operated(view: StationView) -> Operated:
    """Return the running controller that takes set-points, or why there is none."""
    return choose_all_operated(view)[0]


def choose_all_operated(view: StationView) -> tuple[Operated, ...]:
    """Return all running controllers that take set-points of joints.

    Two arms may have a controller each. No two of them command the same joint.

    Returns:
        At least one; where there is none, an entry without name says why.
    """
    found = tuple(
        Operated(controller.name, tuple(elements), view.blocked())
        for controller in view.controllers
        if controller.state == "running"
        and is_of_joints(elements := view.elements.get(controller.name, ()))
    )
    return found or (Operated(reason=_why_none(view)),)


def _why_none(view: StationView) -> str:
    """Return why no controller takes set-points of joints."""
    if view.blocked():
        return view.blocked()
    trouble = choose_rescue(view).trouble
    if trouble:
        return "An arm has stopped by itself. See above what to do."
    running = [c.name for c in view.controllers if c.state == "running"]
    cartesian = [name for name in running if view.elements.get(name)]
    if cartesian:
        return (
            f"{cartesian[0]} moves the end effector, see below. To move single "
            "joints, start a group controller in its place in the Controllers tab."
        )
    what = f"Only {', '.join(running)} runs" if running else "No controller runs"
    return (
        f"{what}, and nothing that runs takes set-points. Start a group "
        "controller in the Controllers tab."
    )


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
