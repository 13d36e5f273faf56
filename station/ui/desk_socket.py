"""The WebSocket through which one browser moves the robot.

The page says what a person does (a typed value, a held button). Set-points are made
here, at a steady rate and a limited speed. When the page falls silent, is closed or
logged out, nothing more is sent, and the joints stay where they were told to be.
"""

import asyncio
import json
import time
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from station.client import ApiError, AsyncStationClient
from station.ui.cartesian_model import HELD_FOR
from station.ui.controller_desk import SetPoint
from station.ui.hand_desk import HandDesks
from station.ui.joint_desk import FASTEST, SLOWEST, JointDesk
from station.ui.operate_model import Movers
from station.ui.socket_ends import close_socket, send_frame, until_first
from station.ui.station_view import StationView

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

SEND_PERIOD = 0.04
"""Time between two set-points [s]."""
_TELL_EVERY = 5
_SESSION_ENDED = 4401
_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Sign = Literal[1, -1]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _Go(_Message):
    do: Literal["go"]
    targets: dict[str, _Finite] = Field(min_length=1, max_length=64)


class _Jog(_Message):
    do: Literal["jog"]
    joint: str
    sign: _Sign


class _HandJog(_Message):
    do: Literal["hand"]
    arm: str
    axis: int = Field(ge=0, le=5)
    sign: _Sign


class _HandGo(_Message):
    do: Literal["reach"]
    arm: str
    position: list[_Finite] = Field(min_length=3, max_length=3)


class _HandSpeed(_Message):
    do: Literal["hand_speed"]
    along: _Finite = Field(gt=0)
    about: _Finite = Field(gt=0)


class _Speed(_Message):
    do: Literal["speed"]
    joints: _Finite = Field(ge=SLOWEST, le=FASTEST)


class _Release(_Message):
    do: Literal["release"]


_Said: TypeAlias = _Go | _Jog | _HandJog | _HandGo | _HandSpeed | _Speed | _Release
_MESSAGE: TypeAdapter[_Said] = TypeAdapter(Annotated[_Said, Field(discriminator="do")])


class DeskSocket:
    """Moves the robot for one browser, until its socket or its session ends.

    Args:
        socket: The browser's WebSocket, not accepted yet.
        client: The station, with the credential of the browser's session.
        view: Returns what is known of the station.
        renew: Lets the client act with what its session has at the station now, and
            returns the lease of control that it acts under; None without one.
        movers: Shared by all desks of the dashboard.
        now: Monotonic clock [s].
    """

    def __init__(
        self,
        socket: "WebSocket",
        client: AsyncStationClient,
        view: Callable[[], StationView],
        renew: Callable[[], str | None] = lambda: None,
        movers: Movers | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._socket = socket
        self._client = client
        self._view = view
        self._renew = renew
        self._now = now
        self._lease: str | None = None
        self._epoch: int | None = None
        self._held_at = float("-inf")
        self._barred_until = float("-inf")
        self._joints = JointDesk(movers)
        self._hands = HandDesks()

    async def run(self, wait_for_end: Callable[[], Awaitable[None]]) -> None:
        """Serve the browser.

        Args:
            wait_for_end: Returns when the browser's session has ended.
        """
        await self._socket.accept()
        await until_first(
            asyncio.ensure_future(wait_for_end()),
            asyncio.create_task(self._listen()),
            asyncio.create_task(self._send()),
        )
        await close_socket(self._socket, _SESSION_ENDED, "the session has ended")

    async def _listen(self) -> None:
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            try:
                self._hear(_MESSAGE.validate_json(message.get("text") or b""))
            except ValidationError as error:
                first = error.errors()[0]
                await self._tell(refused=f"{first['msg']}.")

    def _hear(self, said: _Said) -> None:
        now = self._now()
        view = self._look()
        refusal = ""
        match said:
            case _Go():
                refusal = self._joints.go(said.targets, now)
            case _Jog() | _HandJog() if now < self._barred_until:
                self._barred_until = now + HELD_FOR
            case _Jog():
                refusal = self._joints.hold(said.joint, said.sign, now)
            case _HandJog() | _HandGo() | _HandSpeed():
                refusal = self._hear_of_hand(said, now)
            case _Speed():
                self._joints.set_speed(said.joints)
            case _Release():
                self._joints.release()
                self._hands.release()
        if refusal:
            self._refusal = refusal
        if isinstance(said, (_Jog, _HandJog)):
            self._note_hold(view, now)

    def _hear_of_hand(self, said: _HandJog | _HandGo | _HandSpeed, now: float) -> str:
        """Do what concerns an end effector; return why it is not done, or nothing."""
        match said:
            case _HandJog():
                return self._hands.hold(said.arm, said.axis, said.sign, now)
            case _HandGo():
                return self._hands.go(said.arm, said.position, now)
            case _HandSpeed():
                self._hands.set_speed(said.along, said.about)
                return ""

    _refusal = ""

    def _note_hold(self, view: StationView, now: float) -> None:
        """Note that a button is held; during a stop it has to be pressed anew later."""
        self._held_at = now
        if view.is_stopped:
            self._barred_until = now + HELD_FOR

    async def _send(self) -> None:
        rounds, link = 0, ""
        while True:
            await asyncio.sleep(SEND_PERIOD)
            view = self._look()
            self._look_at_control()
            await self._look_at_others()
            set_points = self._joints.step(SEND_PERIOD, self._now())
            hands = self._hands.step(self._now())
            for set_point in (*set_points, *hands):
                await self._command(set_point)
            rounds += 1
            before, link = link, view.link
            if self._refusal:
                refused, self._refusal = self._refusal, ""
                await self._tell(refused=refused)
            elif rounds % _TELL_EVERY == 0 or link != before:
                await self._tell()

    def _look(self) -> StationView:
        """Look what runs; a new epoch ends every motion, and what is held with it."""
        view = self._view()
        if self._epoch not in {None, view.epoch}:
            self._bar_what_is_held()
        self._epoch = view.epoch
        self._joints.refresh(view)
        self._hands.refresh(view)
        return view

    def _bar_what_is_held(self) -> None:
        """Let a button that is held now be pressed anew before it moves anything."""
        now = self._now()
        if now - self._held_at < HELD_FOR:
            self._barred_until = now + HELD_FOR

    def _look_at_control(self) -> None:
        """End every motion when the control is lost under which it was asked for."""
        before, self._lease = self._lease, self._renew()
        if before is not None and self._lease != before:
            self._let_go()

    async def _look_at_others(self) -> None:
        """End the motion of the joints that another browser has moved since."""
        lost = self._joints.give_up_lost()
        if lost:
            self._bar_what_is_held()
            who = f"Somebody else moves {', '.join(lost)} now"
            await self._tell(
                refused=f"{who}; your motion of it has ended.",
                code="taken_over",
                remedy="Agree who moves it, or take control.",
            )

    def _let_go(self) -> None:
        """Forget every motion; a button that is still held has to be pressed anew."""
        self._barred_until = self._now() + HELD_FOR
        self._joints.let_go()
        self._hands.let_go()

    async def _command(self, set_point: SetPoint) -> None:
        try:
            await self._client.command(
                set_point.controller, set_point.values, epoch=set_point.epoch
            )
        except ApiError as error:
            self._let_go()
            # A stop is no mistake of whoever moved the robot; the strip shows it.
            if error.code == "stopped":
                return
            await self._tell(refused=error.detail, code=error.code, remedy=error.remedy)
        else:
            self._joints.confirm(set_point.controller)

    async def _tell(self, **more: str) -> None:
        """Tell the page what is commanded, what was refused, and how the link is.

        A page that draws slowly would learn by its own questions only some pictures
        later that the station is back.
        """
        content = {
            "link": self._view().link,
            "controller": ", ".join(self._joints.controllers),
            "reason": self._joints.reason,
            "remaining": self._joints.remaining,
            "hands": self._hands.told(),
            **more,
        }
        # When the browser has gone, `_listen` ends the desk.
        await send_frame(self._socket, json.dumps(content))
