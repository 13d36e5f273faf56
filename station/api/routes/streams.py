"""WebSocket streams."""

from typing import NoReturn

from fastapi import WebSocket

from station import wire
from station.api.audit import note_access, origin_of
from station.api.auth import Access, Role
from station.api.control import ControlHeldError
from station.api.dependencies import Viewer
from station.api.errors import ProblemError
from station.api.routes.routing import ApiRouter, problems
from station.api.services import services_of
from station.api.streams import StreamRequestError
from station.api.streams.command_stream import CommandStream, parse_command_request
from station.api.streams.request import parse_request
from station.core.errors import ControllerNotFoundError, StationError
from station.events import EventKind
from station.wire.protocol import LEASE_HEADER

MOST_COMMAND_STREAMS = 16
"""Most streams of set-points at a time."""

router = ApiRouter(tags=["streams"])


def access_of(websocket: WebSocket) -> Access | None:
    """Return the access that a WebSocket's ticket, token or cookie proves."""
    authenticator = services_of(websocket).authenticator
    ticket = websocket.query_params.get("ticket")
    if ticket is not None:
        return authenticator.redeem_ticket(ticket)
    return authenticator.access_of_headers(websocket.headers)


@router.websocket("/streams/command/{controller}")
async def command_stream(websocket: WebSocket, controller: str) -> None:
    """Accept a stream of set-points; a refusal is a close code.

    Raises:
        StreamRequestError: Never raised: it becomes a close code.
    """
    access = await accepted_access(websocket)
    if access is None:
        return
    services = services_of(websocket)
    try:
        if not access.role.includes(Role.OPERATOR):
            raise StreamRequestError("Only operators command.", wire.CLOSE_FORBIDDEN)
        lease = websocket.headers.get(LEASE_HEADER)
        services.control.check(access, lease)
        services.station.motion.set_point(controller)
        request = parse_command_request(controller, websocket.query_params, lease)
        if services.command_streams >= MOST_COMMAND_STREAMS:
            reason = f"there are {MOST_COMMAND_STREAMS} command streams already"
            raise StreamRequestError(reason, wire.CLOSE_TRY_LATER)
    except StreamRequestError as error:
        await websocket.close(error.close_code, error.reason)
        return
    except StationError as error:
        await websocket.close(_close_code(error), _short(error.message))
        return
    stream = CommandStream(services.station, services.control, access, request)
    services.command_streams += 1
    origin = origin_of(websocket)
    log = services.event_recorder.log
    text = f"{origin.who} sends set-points to '{controller}'."
    log.record(
        EventKind.COMMAND_STREAM, text, what=controller, result="open", origin=origin
    )
    code, reason = 0, ""
    try:
        closing = services.broadcaster.wait_closing
        code, reason = await stream.serve(websocket, closing)
    finally:
        services.command_streams -= 1
        log.record(
            EventKind.COMMAND_STREAM,
            f"{origin.who} sends no more set-points to '{controller}'.",
            what=controller,
            result=str(code or "closed"),
            details=stream.counts(),
            origin=origin,
        )
    if code:
        await websocket.close(code, _short(reason))


def _close_code(error: StationError) -> int:
    if isinstance(error, ControlHeldError):
        return wire.CLOSE_CONTROL_HELD
    if isinstance(error, ControllerNotFoundError):
        return wire.CLOSE_UNKNOWN_TOPIC
    return wire.CLOSE_BAD_REQUEST


def _short(reason: str) -> str:
    """Return a reason, shortened to fit into a close frame."""
    return reason.encode()[:120].decode(errors="ignore")


async def accepted_access(websocket: WebSocket) -> Access | None:
    """Accept a WebSocket and return its rights; close it if it proves none."""
    services = services_of(websocket)
    await websocket.accept()
    access = access_of(websocket)
    if access is None:
        if "authorization" in websocket.headers:
            services.event_recorder.failed_login(websocket)
            await services.failed_logins.slow_down(websocket)
        reason = "The token, session or ticket is missing, unknown or too old."
        await websocket.close(wire.CLOSE_UNAUTHORIZED, reason)
        return None
    note_access(websocket, access)
    return access


@router.websocket("/streams/{topic:path}")
async def stream(websocket: WebSocket, topic: str) -> None:
    """Stream a topic; refuse by a close code after accepting, as browsers need it."""
    services = services_of(websocket)
    access = await accepted_access(websocket)
    if access is None:
        return
    try:
        request, source = parse_request(
            services.station,
            topic,
            websocket.query_params,
            services.event_recorder.log,
        )
    except StreamRequestError as error:
        await websocket.close(error.close_code, error.reason)
        return
    await services.broadcaster.serve(websocket, request, source, access)


@router.get(
    "/streams/{topic:path}",
    dependencies=[Viewer],
    responses=problems(426),
    response_model=None,
)
async def stream_needs_websocket(topic: str) -> NoReturn:
    """Open `ws://…/api/v1/streams/{topic}?rate=HZ&fields=a,b&format=json|msgpack`.

    Topics: `joint_states`, `controllers`, `loop`, `scene`, `events`,
    `controller_state/{name}`, `robot_state/{arm_id}`. The first frame is `{"topic":
    "hello", "boot_id", "epoch", "data": {…}}` with a snapshot of everything; every
    frame has `topic`, `seq`, `epoch`, `cycle`, `stamp`, `data`. A slow client misses
    frames, which gaps in `seq` show. `rate=full` sends every cycle in batches:
    `data.samples` has the samples with their `cycle`, `data.lost` the number of cycles
    that were overwritten before they were sent, and `data.skipped` the number of
    deadlines for which the loop made no cycle. Programs send their bearer token,
    browsers a ticket of POST /api/v1/stream-tickets as `&ticket=…`. Close codes: 4400
    bad request, 4401 no token, 4403 wrong origin, 4404 no such topic, 4408 too slow,
    1001 shutting down.

    Raises:
        ProblemError: Always, because this is a WebSocket.
    """
    raise ProblemError(
        426,
        "websocket_needed",
        f"'{topic}' is streamed over a WebSocket, not over plain HTTP.",
        "Open it with a WebSocket client, e.g. station.client's stream().",
        {"Upgrade": "websocket", "Connection": "Upgrade"},
    )
