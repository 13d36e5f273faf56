"""Make set-points of the commands of one person, and send them to the station."""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass

from station.client import ApiError, AsyncStationClient
from station.ui.link.station_view import StationView
from station.ui.teleoperation.hand_teleoperation import HandsTeleoperation
from station.ui.teleoperation.joint_teleoperation import (
    HELD_FOR,
    JointTeleoperation,
    Movers,
    SetPoint,
)

SEND_PERIOD = 0.04
"""Time between two set-points [s]."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """A reason why a motion does not begin or has ended.

    Attributes:
        detail: The reason, for people.
        code: The reason, for programs.
        remedy: Advice to the user; empty if nothing helps.
    """

    detail: str
    code: str = "not_sent"
    remedy: str = ""


class Teleoperation:
    """Moves the robot for one browser, or for Viser's panel.

    Args:
        client: The station; with the credential under which the person acts.
        view: Returns the dashboard's knowledge of the station.
        movers: The mover of each joint, shared by all that command joints.
        renew: Lets the client act with the present credential of its session, and
            returns the lease of control that it acts under; None without one.
        now: Monotonic clock [s].

    Attributes:
        joints: The commands to joints.
        hands: The commands to end effectors.
        view: As given.
        now: As given.
    """

    def __init__(
        self,
        client: AsyncStationClient,
        view: Callable[[], StationView],
        movers: Movers | None = None,
        renew: Callable[[], str | None] = lambda: None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.joints = JointTeleoperation(movers)
        self.hands = HandsTeleoperation()
        self.view = view
        self.now = now
        self._client = client
        self._renew = renew
        self._lease: str | None = None
        self._epoch: int | None = None
        self._held_at = float("-inf")
        self._barred_until = float("-inf")
        self._ended_by_link: list[Refusal] = []
        self._due_since = float("-inf")

    def refresh(self) -> StationView:
        """Note which controllers run; a new epoch ends every motion and held button."""
        view = self.view()
        if self._epoch not in {None, view.epoch}:
            self._bar_held_buttons()
        self._epoch = view.epoch
        was_pursuing = self._is_pursuing
        self.joints.refresh(view)
        self.hands.refresh(view)
        # The strip of the page is grey for a moment, which nobody connects with a robot
        # that stands still on its way.
        if was_pursuing and not self._is_pursuing and view.link != "live":
            detail = f"The link to the station was {view.link}; the motion has ended."
            remedy = "Ask for the motion again."
            self._ended_by_link = [Refusal(detail, "link_interrupted", remedy)]
        return view

    @property
    def _is_pursuing(self) -> bool:
        return self.joints.is_pursuing or self.hands.is_pursuing

    def hold(self, hold: Callable[[float], str]) -> str:
        """Move while a button is held.

        Args:
            hold: Function that tells a joint or a hand that its button is held at a
                time [s].

        Returns:
            Why it does not move; empty when it does.
        """
        view, now = self.refresh(), self.now()
        refusal = ""
        if now < self._barred_until:
            self._barred_until = now + HELD_FOR
        else:
            refusal = hold(now)
        self._held_at = now
        # A button that is held during a stop must not move the robot after the release.
        if view.is_stopped:
            self._barred_until = now + HELD_FOR
        return refusal

    def release(self) -> None:
        """Treat all held buttons as released."""
        self.joints.release()
        self.hands.release()

    def let_go(self) -> None:
        """Forget every motion; a button that is still held has to be pressed anew."""
        self._barred_until = self.now() + HELD_FOR
        self.joints.let_go()
        self.hands.let_go()

    async def wait_until_due(self) -> None:
        """Wait until the next set-points are due, a `SEND_PERIOD` after the last ones.

        The time in which the station answers belongs to the period: a motion would
        otherwise be slower than asked for.
        """
        passed = self.now() - self._due_since
        await asyncio.sleep(max(SEND_PERIOD - passed, 0.0))
        self._due_since = self.now()

    async def send_set_points(self) -> list[Refusal]:
        """Send the set-points of one period; call whenever they are due.

        Returns:
            The motions that have ended early.
        """
        self.refresh()
        before, self._lease = self._lease, self._renew()
        # What was asked for under a lease must not go on under that of somebody else.
        if before is not None and self._lease != before:
            self.let_go()
        refusals = [*self._ended_by_link, *self._give_up_lost()]
        self._ended_by_link = []
        set_points = [
            *self.joints.step(SEND_PERIOD, self.now()),
            *self.hands.step(self.now()),
        ]
        for set_point in set_points:
            refusals += await self._send(set_point)
        return refusals

    def _bar_held_buttons(self) -> None:
        now = self.now()
        if now - self._held_at < HELD_FOR:
            self._barred_until = now + HELD_FOR

    def _give_up_lost(self) -> list[Refusal]:
        """End the motion of the joints that another mover has moved since."""
        lost = self.joints.give_up_lost()
        if not lost:
            return []
        self._bar_held_buttons()
        detail = (
            f"Somebody else moves {', '.join(lost)} now; your motion of it has ended."
        )
        remedy = "Agree who moves it, or take control."
        return [Refusal(detail, "taken_over", remedy)]

    async def _send(self, set_point: SetPoint) -> list[Refusal]:
        try:
            await self._client.command(
                set_point.controller, set_point.values, epoch=set_point.epoch
            )
        except ApiError as error:
            self.let_go()
            # A stop is no mistake of the person at the page, and the strip shows it.
            if error.code == "stopped":
                return []
            return [Refusal(error.detail, error.code, error.remedy)]
        self.joints.confirm(set_point.controller)
        return []
