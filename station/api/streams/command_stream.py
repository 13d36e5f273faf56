"""Streams of set-points: the newest one counts, and expires when the client is silent.

The set-points have the same checks and limits as those of PUT
`/controllers/{name}/command`. Of the messages that come between two turns of the event
loop, only the last one is parsed; the others are reported as superseded.
"""

import asyncio
import json
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec.msgpack
import orjson
from pydantic import ValidationError
from starlette.websockets import WebSocket, WebSocketDisconnect

from station import wire
from station.api.auth import Access
from station.api.control import Control, ControlHeldError
from station.api.json_route import DoubleNameError, check_names
from station.api.streams.request import StreamRequestError, read_format
from station.core.errors import StationError
from station.core.facade.station import Station
from station.wire.validation_words import explain, explain_json

if TYPE_CHECKING:
    from station.core.ports.command_ticket import CommandTicket

DEFAULT_TIMEOUT = 0.2
"""Default silence after which a set-point expires [s]."""
LONGEST_TIMEOUT = 60.0
"""Longest timeout that a client may request [s]."""
REPORT_PERIOD = 0.5
"""Period of the reports to the sender [s]."""


@dataclass(frozen=True, slots=True)
class CommandStreamRequest:
    """The request for a stream of set-points.

    Attributes:
        controller: The controller.
        timeout: Silence after which the last set-point expires [s], > 0.
        format: Encoding of the messages.
        lease: The lease of control under which the client sends; None without one.
    """

    controller: str
    timeout: float
    format: wire.StreamFormat
    lease: str | None


def parse_command_request(
    controller: str, query: Mapping[str, str], lease: str | None
) -> CommandStreamRequest:
    """Return the parsed request for a stream of set-points.

    Args:
        controller: The controller.
        query: The URL's query.
        lease: The lease of control under which the client sends; None without one.

    Raises:
        StreamRequestError: A parameter is wrong.
    """
    unknown = set(query) - {"timeout", "format", "ticket"}
    if unknown:
        raise StreamRequestError(
            f"There is no parameter {min(unknown)!r:.30}. Use timeout or format."
        )
    try:
        timeout = float(query.get("timeout", DEFAULT_TIMEOUT))
    except ValueError:
        timeout = 0.0
    if not 0.0 < timeout <= LONGEST_TIMEOUT:
        raise StreamRequestError(
            f"The timeout is {query['timeout']!r:.20}. Give a time up to "
            f"{LONGEST_TIMEOUT:g} [s]."
        )
    return CommandStreamRequest(controller, timeout, read_format(query), lease)


class CommandStream:
    """Accepts the set-points of one client. Use it in one event loop only.

    Args:
        station: The station.
        control: The lease of control.
        access: Rights of the client.
        request: Request of the client.
    """

    def __init__(
        self,
        station: Station,
        control: Control,
        access: Access,
        request: CommandStreamRequest,
    ) -> None:
        self._station = station
        self._control = control
        self._access = access
        self._request = request
        self._newest: bytes | str | None = None
        self._news = asyncio.Event()
        self._received = 0
        self._applied = 0
        self._refused = 0
        self._waiting: CommandTicket | None = None
        self._error: dict[str, object] | None = None

    def counts(self) -> dict[str, object]:
        """Return the report to the sender, with the counts of set-points."""
        self._settle()
        pending = int(self._waiting is not None) + int(self._newest is not None)
        superseded = self._received - self._applied - self._refused - pending
        return {
            "received": self._received,
            "applied": self._applied,
            "superseded": superseded,
            "refused": self._refused,
            "pending": pending,
            "cycle": self._station.loop.cycle,
            "epoch": self._station.epoch,
            "error": self._error,
        }

    async def serve(
        self,
        websocket: WebSocket,
        closing: Callable[[], Coroutine[object, object, None]],
    ) -> tuple[int, str]:
        """Accept set-points until either side ends; return close code and reason.

        Args:
            websocket: The accepted connection.
            closing: Returns when the station shuts down.

        Returns:
            Close code and reason; code 0 if the client has already left.
        """
        changed, loop = asyncio.Event(), asyncio.get_running_loop()
        end_listening = self._control.listen(lambda: _set_from_anywhere(loop, changed))
        ends = {
            asyncio.create_task(self._receive(websocket)): (0, ""),
            asyncio.create_task(self._report(websocket)): (0, ""),
            asyncio.create_task(self._apply_newest()): (0, ""),
            asyncio.create_task(self._wait_for_loss(changed)): (
                wire.CLOSE_CONTROL_HELD,
                "somebody else holds control",
            ),
            asyncio.create_task(self._access.wait_for_end()): (
                wire.CLOSE_UNAUTHORIZED,
                "the token or session has ended",
            ),
            asyncio.create_task(closing()): (
                wire.CLOSE_GOING_AWAY,
                "the station shuts down",
            ),
        }
        try:
            done, _ = await asyncio.wait(ends, return_when=asyncio.FIRST_COMPLETED)
            return self._how_to_close(ends[next(iter(done))], done)
        finally:
            end_listening()
            for task in ends:
                task.cancel()
            await asyncio.gather(*ends, return_exceptions=True)

    def _how_to_close(
        self, usual: tuple[int, str], done: "set[asyncio.Task[None]]"
    ) -> tuple[int, str]:
        for task in done:
            error = task.exception()
            if isinstance(error, WebSocketDisconnect):
                return 0, ""
            if isinstance(error, ControlHeldError):
                return wire.CLOSE_CONTROL_HELD, error.message[:120]
            if error is not None:
                return wire.CLOSE_BAD_REQUEST, str(error)[:120]
        return usual

    async def _receive(self, websocket: WebSocket) -> None:
        while True:
            message = await websocket.receive()
            if message["type"] == "websocket.disconnect":
                return
            self._newest = message.get("text") or message.get("bytes") or b""
            self._received += 1
            self._news.set()

    async def _apply_newest(self) -> None:
        """Apply the newest message, at most once per cycle.

        Raises:
            ControlHeldError: Another client holds control.
        """
        while True:
            await self._news.wait()
            self._news.clear()
            message, self._newest = self._newest, None
            if message is None:
                continue
            self._settle()
            # Check before the message is parsed: a loss of control ends the stream,
            # whatever the message contains.
            self._control.check(self._access, self._request.lease)
            try:
                self._apply(message)
            except ControlHeldError:
                raise
            except (StationError, ValueError) as error:
                self._refused += 1
                self._error = _told(error)
            # More than one set-point per cycle would have no effect.
            await asyncio.sleep(self._station.loop.period)

    def _apply(self, message: bytes | str) -> None:
        """Check a set-point, and give it to the controller.

        Raises:
            ControlHeldError: Another client holds control.
            ValueError: The message is malformed, or wants to be valid for too long.
        """
        motion, request = self._station.motion, self._request
        command = _read(message, request.format)
        timeout = request.timeout if command.timeout is None else command.timeout
        if not 0.0 < timeout <= request.timeout:
            raise ValueError(
                f"timeout: is {timeout} s; a set-point of this stream is valid for "
                f"more than 0 and at most {request.timeout} s."
            )
        ticket = motion.ticket()
        with self._control.commanding(self._access, request.lease, request.controller):
            motion.set_command(
                request.controller,
                command.command,
                command.epoch,
                timeout,
                command.rates,
                ticket,
            )
        self._waiting = ticket

    def _settle(self) -> None:
        """Count the last given set-point, if a cycle has taken it."""
        if self._waiting is not None and self._waiting.accepted_cycle is not None:
            self._applied += 1
            self._waiting = None

    async def _report(self, websocket: WebSocket) -> None:
        sent: dict[str, object] = {}
        while True:
            await asyncio.sleep(REPORT_PERIOD)
            found = self.counts()
            # A report in which only the cycle has changed is not sent.
            if {**found, "cycle": 0} != {**sent, "cycle": 0}:
                sent = found
                await _send(websocket, self._request.format, found)

    async def _wait_for_loss(self, changed: asyncio.Event) -> None:
        while not self._control.is_lost(self._access, self._request.lease):
            changed.clear()
            await changed.wait()


def _set_from_anywhere(loop: asyncio.AbstractEventLoop, event: asyncio.Event) -> None:
    # A listener may still be called while the server shuts down.
    if not loop.is_closed():
        loop.call_soon_threadsafe(event.set)


async def _send(
    websocket: WebSocket, form: wire.StreamFormat, message: dict[str, object]
) -> None:
    if form == "json":
        await websocket.send_text(orjson.dumps(message).decode())
    else:
        await websocket.send_bytes(msgspec.msgpack.encode(message))


def _read(message: bytes | str, form: wire.StreamFormat) -> wire.CommandRequest:
    """Return the set-point in a message.

    Raises:
        DoubleNameError: The message has a key twice.
        ValueError: The message has no set-point. Errors of pydantic and of both
            decoders are ValueErrors, too.
    """
    if form == "json":
        values = orjson.loads(message)
        # A set-point has no inner objects: more colons are keys that are there twice.
        text = message if isinstance(message, bytes) else message.encode()
        if isinstance(values, dict) and text.count(b":") > len(values):
            check_names(message)
    else:
        raw = message if isinstance(message, bytes) else message.encode()
        try:
            values = msgspec.msgpack.decode(raw)
        except msgspec.DecodeError as error:
            raise ValueError(f"The message is no msgpack: {error}.") from error
        if isinstance(values, dict) and _count_of_pairs(raw) != len(values):
            raise DoubleNameError("has a key twice in one object")
    if isinstance(values, list):
        values = {"command": values}
    return wire.CommandRequest.model_validate(values)


def _count_of_pairs(raw: bytes) -> int:
    """Return the number of keys of a map of msgpack, with those that come twice."""
    if raw[0] < _MAP_16:
        return raw[0] & 0x0F
    return int.from_bytes(raw[1 : 3 if raw[0] == _MAP_16 else 5])


_MAP_16 = 0xDE
"""First byte of a map of msgpack with a 16-bit count; before it are short maps."""


def _told(error: StationError | ValueError) -> dict[str, object]:
    """Return an error in the form of the report to the sender."""
    if isinstance(error, StationError):
        return {
            "code": error.code,
            "detail": error.message,
            "remedy": error.remedy or "See the detail.",
        }
    if isinstance(error, json.JSONDecodeError):
        detail = f"The message {explain_json(error.doc, error.pos, error.msg)}."
    elif isinstance(error, ValidationError):
        first = error.errors()[0]
        field = "".join(f"{part}/" for part in first["loc"])[:-1]
        words = explain(first["type"], first.get("ctx", {}))
        detail = f"{field}: {words}." if field else f"The message {words}."
    elif isinstance(error, DoubleNameError):
        detail = f"The message {error}."
    else:
        detail = str(error)
    remedy = 'Send {"command": [one number per element]}.'
    return {"code": "invalid_request", "detail": detail, "remedy": remedy}
