"""What one person asks of an end effector: held directions, and a typed position."""

from collections.abc import Sequence
from dataclasses import dataclass

from station.ui.cartesian_model import (
    POSE,
    TWIST,
    HeldButtons,
    TargetPose,
    arms_to_move,
    choose_cartesian,
)
from station.ui.controller_desk import SetPoint
from station.ui.operate_model import Operated
from station.ui.station_view import StationView

JOG_KIND = "CartesianJogController"
TARGET_KIND = "CartesianStreamingController"
SLOWEST_HAND = 0.005
"""Slowest speed of a held direction that a person may choose [m/s] or [rad/s]."""
_FIRST_TURN = 3


@dataclass(frozen=True, slots=True)
class HandSpeed:
    """How fast held buttons move an end effector.

    Attributes:
        along: Speed of a held direction [m/s].
        about: Angular speed of a held direction [rad/s].
    """

    along: float = 0.05
    about: float = 0.3


class HandDesk:
    """The commands of one browser to one end effector.

    Args:
        arm: The arm that carries it; empty where there are not several.

    Attributes:
        jog: The controller that held buttons command, or why there is none.
        target: The controller that goes to a pose, or why there is none.
        message: Why the motion waits or slows down; empty when it does not.
        speed: How fast held buttons move it, unless its controller allows less.
    """

    def __init__(self, arm: str = "") -> None:
        self.jog = Operated()
        self.target = Operated()
        self.message = ""
        self.speed = HandSpeed()
        self._arm = arm
        self._epoch: int | None = None
        self._buttons = HeldButtons()
        self._pose = TargetPose()
        self._desired: list[float] = []

    def refresh(self, view: StationView) -> None:
        """Look which controllers run; a new epoch ends what was asked for before."""
        jog = choose_cartesian(view, TWIST, JOG_KIND, self._arm)
        target = choose_cartesian(view, POSE, TARGET_KIND, self._arm)
        is_other = view.epoch != self._epoch
        if jog.reason or is_other or jog.name != self.jog.name:
            self._buttons.let_go()
        if target.reason or is_other or target.name != self.target.name:
            self._pose.let_go()
            self._desired = []
        self.jog, self.target, self._epoch = jog, target, view.epoch
        messages = (view.messages.get(one.name, "") for one in (jog, target))
        self.message = next(filter(None, messages), "")
        sample = view.samples.get(target.name)
        if sample is not None and len(sample.desired) == len(POSE):
            known = [value for value in sample.desired if value is not None]
            self._desired = known if len(known) == len(POSE) else []

    @property
    def fastest(self) -> HandSpeed | None:
        """What the jog controller allows; None where it says nothing, or none runs."""
        if len(self.jog.elements) != len(TWIST):
            return None
        along = self.jog.elements[0].maximum
        about = self.jog.elements[_FIRST_TURN].maximum
        return None if along is None or about is None else HandSpeed(along, about)

    def hold(self, axis: int, sign: int, now: float) -> str:
        """Move along or about an axis for as long as its button is held.

        Args:
            axis: Index in `TWIST`.
            sign: 1 or -1.
            now: Monotonic time [s] at which the browser said so.

        Returns:
            Why it does not move; empty when it does.
        """
        if self.jog.reason or not self.jog.name:
            return self.jog.reason
        self._buttons.hold(axis, sign, now)
        return ""

    def go(self, position: Sequence[float], now: float) -> str:
        """Go to a position; the orientation stays as it is.

        Args:
            position: x, y, z in the arm's base [m].
            now: Monotonic time [s].

        Returns:
            Why it does not move; empty when it does.
        """
        if self.target.reason or not self.target.name:
            return self.target.reason
        if not self._desired:
            return "It is not known yet where the hand was told to be. Try again."
        self._pose.drag([*position, *self._desired[3:]], now)
        return ""

    def release(self) -> None:
        """Treat all held buttons as released; the next step commands rest."""
        for axis in range(len(TWIST)):
            for sign in (1, -1):
                self._buttons.release(axis, sign)

    def let_go(self) -> None:
        """Forget every motion, and send no more for it."""
        self._buttons.let_go()
        self._pose.let_go()

    def step(self, now: float) -> SetPoint | None:
        """Return the next set-point to send, or None when there is nothing to send.

        Args:
            now: Monotonic time [s].
        """
        most = self.fastest or self.speed
        along = min(self.speed.along, most.along)
        twist = self._buttons.twist(now, along, min(self.speed.about, most.about))
        if twist is not None:
            return SetPoint(self.jog.name, twist, self._epoch)
        if not self._desired:
            return None
        pose = self._pose.command(self._desired, now)
        return None if pose is None else SetPoint(self.target.name, pose, self._epoch)


class HandDesks:
    """The commands of one browser to the end effectors of all arms.

    Attributes:
        desks: One for each arm, by name; under an empty name where there are not
            several arms.
    """

    def __init__(self) -> None:
        self.desks = {"": HandDesk()}
        self._speed = HandSpeed()

    def refresh(self, view: StationView) -> None:
        """Look which arms there are, and which controllers run."""
        arms = arms_to_move(view)
        self.desks = {arm: self.desks.get(arm) or HandDesk(arm) for arm in arms}
        for desk in self.desks.values():
            desk.speed = self._speed
            desk.refresh(view)

    def set_speed(self, along: float, about: float) -> None:
        """Limit the speed of held directions.

        Args:
            along: Speed [m/s]; at least `SLOWEST_HAND`.
            about: Angular speed [rad/s]; at least `SLOWEST_HAND`.
        """
        self._speed = HandSpeed(max(along, SLOWEST_HAND), max(about, SLOWEST_HAND))

    def hold(self, arm: str, axis: int, sign: int, now: float) -> str:
        """Move one hand while a button is held; as `HandDesk.hold`."""
        desk = self._desk_of(arm)
        return _no_arm(arm) if desk is None else desk.hold(axis, sign, now)

    def go(self, arm: str, position: Sequence[float], now: float) -> str:
        """Let one hand go to a position; as `HandDesk.go`."""
        desk = self._desk_of(arm)
        return _no_arm(arm) if desk is None else desk.go(position, now)

    def release(self) -> None:
        """Treat all held buttons as released; the next step commands rest."""
        for desk in self.desks.values():
            desk.release()

    def let_go(self) -> None:
        """Forget every motion, and send no more for it."""
        for desk in self.desks.values():
            desk.let_go()

    def step(self, now: float) -> list[SetPoint]:
        """Return the next set-points to send, at most one for each hand."""
        steps = (desk.step(now) for desk in self.desks.values())
        return [set_point for set_point in steps if set_point is not None]

    def told(self) -> dict[str, object]:
        """Return by arm which controllers move its hand and how fast, for the page."""
        return {arm: _told(desk) for arm, desk in self.desks.items()}

    def _desk_of(self, arm: str) -> HandDesk | None:
        """Return the desk of an arm; a single arm is also meant by its own name."""
        return self.desks.get(arm, self.desks.get(""))


def _told(desk: HandDesk) -> dict[str, object]:
    most = desk.fastest
    return {
        "jog": {"controller": desk.jog.name, "reason": desk.jog.reason},
        "target": {"controller": desk.target.name, "reason": desk.target.reason},
        "message": desk.message,
        "fastest": None if most is None else [most.along, most.about],
    }


def _no_arm(arm: str) -> str:
    return f"This station has no arm '{arm}'."
