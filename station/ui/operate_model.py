"""Which controller the joint sliders command, and how fast a set-point may move.

The sliders follow the robot until somebody touches one. Then the touched element
travels to its target at a limited speed, so that a click at the far end of a slider is
no step for the robot. After anything unexpected (a stop, another controller, a
refusal) no more set-points are sent, and the sliders follow the robot again.
"""

from collections.abc import Sequence
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


def is_of_joints(elements: Sequence[CommandElement]) -> bool:
    """Return whether a set-point has one number per joint."""
    return bool(elements) and elements[0].name not in _OF_THE_END_EFFECTOR


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


class SetPointRamp:
    """A set-point that travels from the last commanded values to the wanted values.

    Args:
        elements: The numbers of the set-point. The speed of positions is limited; other
            quantities are sent as they are.
    """

    def __init__(self, elements: Sequence[CommandElement]) -> None:
        self._limited = [element.unit in POSITION_UNITS for element in elements]
        self._current: list[float] | None = None
        self._target: list[float] | None = None
        self._touched_at: dict[int, float] = {}

    @property
    def commanding(self) -> bool:
        """Whether the set-point has not reached the wanted values yet."""
        return self._target is not None

    @property
    def is_known(self) -> bool:
        """Whether the last set-point of the controller is known."""
        return self._current is not None

    @property
    def remaining(self) -> float:
        """Largest remaining distance of an element with limited speed [rad] or [m]."""
        if self._target is None or self._current is None:
            return 0.0
        pairs = zip(self._target, self._current, strict=True)
        return max((abs(target - now) for target, now in pairs), default=0.0)

    def follow(self, set_point: Sequence[float]) -> None:
        """Start from the last set-point of the controller, unless a person commands.

        Args:
            set_point: One number per element, in their units.
        """
        if self._target is None:
            self._current = list(set_point)

    def touch(self, index: int, value: float, now: float) -> bool:
        """Set the target of one element.

        Args:
            index: Index of the element.
            value: The wanted value, in the unit of the element.
            now: Monotonic time [s].

        Returns:
            False while the last set-point of the controller is not known.
        """
        if self._current is None:
            return False
        if self._target is None:
            self._target = list(self._current)
        self._target[index] = value
        self._touched_at[index] = now
        return True

    def let_go(self) -> None:
        """Forget the target; follow the robot again."""
        self._target = None
        self._current = None
        self._touched_at.clear()

    def halt(self) -> None:
        """Stay at the last set-point; the robot is where it was told to be."""
        self._target = None
        self._touched_at.clear()

    def step(self, dt: float, speed: float) -> list[float] | None:
        """Return the next set-point to send, or None when there is nothing to send.

        Args:
            dt: Time since the last step [s].
            speed: Fastest change of a position [rad/s] or [m/s], > 0.
        """
        if self._target is None or self._current is None:
            return None
        reach = speed * dt
        for i, target in enumerate(self._target):
            away = target - self._current[i]
            if self._limited[i] and abs(away) > reach:
                self._current[i] += reach if away > 0.0 else -reach
            else:
                self._current[i] = target
        command = list(self._current)
        if command == self._target:
            self._target = None
        return command

    def shown(self, index: int, now: float) -> float | None:
        """Return what slider `index` should show, or None to leave it as it is."""
        if now - self._touched_at.get(index, float("-inf")) < HOLD:
            return None
        if self._target is not None:
            return self._target[index]
        return None if self._current is None else self._current[index]
