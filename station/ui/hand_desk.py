"""What one person asks of the end effector: held directions, and a typed position."""

from collections.abc import Sequence

from station.ui.cartesian_model import (
    POSE,
    TWIST,
    HeldButtons,
    TargetPose,
    choose_cartesian,
)
from station.ui.controller_desk import SetPoint
from station.ui.operate_model import Operated
from station.ui.station_view import StationView

JOG_KIND = "CartesianJogController"
TARGET_KIND = "CartesianStreamingController"


class HandDesk:
    """The commands of one browser to the end effector.

    Attributes:
        jog: The controller that held buttons command, or why there is none.
        target: The controller that goes to a pose, or why there is none.
        speed: Speed of a held direction [m/s].
        turn: Angular speed of a held direction [rad/s].
    """

    def __init__(self) -> None:
        self.jog = Operated()
        self.target = Operated()
        self.speed = 0.05
        self.turn = 0.3
        self._epoch: int | None = None
        self._buttons = HeldButtons()
        self._pose = TargetPose()
        self._desired: list[float] = []

    def refresh(self, view: StationView) -> None:
        """Look which controllers run; a new epoch ends what was asked for before."""
        jog = choose_cartesian(view, TWIST, JOG_KIND)
        target = choose_cartesian(view, POSE, TARGET_KIND)
        is_other = view.epoch != self._epoch
        if jog.reason or is_other or jog.name != self.jog.name:
            self._buttons.let_go()
        if target.reason or is_other or target.name != self.target.name:
            self._pose.let_go()
            self._desired = []
        self.jog, self.target, self._epoch = jog, target, view.epoch
        sample = view.samples.get(target.name)
        if sample is not None and len(sample.desired) == len(POSE):
            known = [value for value in sample.desired if value is not None]
            self._desired = known if len(known) == len(POSE) else []

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
        twist = self._buttons.twist(now, self.speed, self.turn)
        if twist is not None:
            return SetPoint(self.jog.name, twist, self._epoch)
        if not self._desired:
            return None
        pose = self._pose.command(self._desired, now)
        return None if pose is None else SetPoint(self.target.name, pose, self._epoch)
