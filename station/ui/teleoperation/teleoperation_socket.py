"""The WebSocket through which one browser moves the robot.

The page sends the acts of a person (a typed value, a held button). Set-points are made
here, at a steady rate and a limited speed. When the page falls silent, is closed or
logged out, nothing more is sent, and the joints stay at their last set-points.
"""

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from station.ui.link.socket_ends import close_socket, send_frame, until_first
from station.ui.teleoperation.joint_teleoperation import FASTEST, SLOWEST
from station.ui.teleoperation.teleoperation import Refusal, Teleoperation
from station.wire.rehearsal import Place

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

_STATE_EVERY = 5
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
    sign: _Finite = Field(ge=-1, le=1)


class _HandGo(_Message):
    do: Literal["reach"]
    arm: str
    place: Place
    step_in: Literal["", "base", "tool"] = ""


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


class TeleoperationSocket:
    """Moves the robot for one browser, until its socket or its session ends.

    Args:
        socket: The browser's WebSocket, not accepted yet.
        teleoperation: The commands of this browser.
    """

    def __init__(self, socket: "WebSocket", teleoperation: Teleoperation) -> None:
        self._socket = socket
        self._teleoperation = teleoperation
        self._refusal = ""

    async def run(self, wait_for_end: Callable[[], Awaitable[None]]) -> None:
        """Serve the browser.

        Args:
            wait_for_end: Returns when the browser's session has ended.
        """
        await self._socket.accept()
        await until_first(
            asyncio.ensure_future(wait_for_end()),
            asyncio.create_task(self._listen()),
            asyncio.create_task(self._send_set_points()),
        )
        await close_socket(self._socket, _SESSION_ENDED, "the session has ended")

    async def _listen(self) -> None:
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            try:
                said = _MESSAGE.validate_json(message.get("text") or b"")
            except ValidationError as error:
                await self._send_state(refused=f"{error.errors()[0]['msg']}.")
            else:
                self._refusal = self._carry_out(said) or self._refusal

    def _carry_out(self, said: _Said) -> str:
        """Carry out a message; return why it is refused, or an empty text."""
        asked = self._teleoperation
        joints, hands = asked.joints, asked.hands
        match said:
            case _Jog():
                return asked.hold(lambda t: joints.hold(said.joint, said.sign, t))
            case _HandJog():
                arm, axis, sign = said.arm, said.axis, said.sign
                return asked.hold(lambda t: hands.hold(arm, axis, sign, t))
        asked.refresh()
        match said:
            case _Go():
                return joints.go(said.targets, asked.now())
            case _HandGo():
                pose = [*said.place.position, *(said.place.quaternion() or ())]
                return hands.go(said.arm, pose, asked.now(), said.step_in)
            case _HandSpeed():
                hands.set_speed(said.along, said.about)
            case _Speed():
                joints.set_speed(said.joints)
            case _Release():
                asked.release()
        return ""

    async def _send_set_points(self) -> None:
        rounds, link = 0, ""
        while True:
            await self._teleoperation.wait_until_due()
            for refusal in await self._teleoperation.send_set_points():
                await self._send_refusal(refusal)
            rounds += 1
            before, link = link, self._teleoperation.view().link
            if self._refusal:
                refused, self._refusal = self._refusal, ""
                await self._send_state(refused=refused)
            # A page that draws slowly would learn by its own questions only some
            # pictures later that the station is back.
            elif rounds % _STATE_EVERY == 0 or link != before:
                await self._send_state()

    async def _send_refusal(self, refusal: Refusal) -> None:
        await self._send_state(
            refused=refusal.detail, code=refusal.code, remedy=refusal.remedy
        )

    async def _send_state(self, **more: str) -> None:
        """Send the commanded controllers, a refusal, and the state of the link."""
        joints = self._teleoperation.joints
        content = {
            "link": self._teleoperation.view().link,
            "controller": ", ".join(joints.controllers),
            "reason": joints.reason,
            "remaining": joints.remaining,
            "hands": self._teleoperation.hands.state(),
            **more,
        }
        # When the browser has gone, `_listen` ends the socket.
        await send_frame(self._socket, json.dumps(content))
