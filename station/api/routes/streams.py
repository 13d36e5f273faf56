"""WebSocket streams."""

from typing import TYPE_CHECKING, NoReturn

from fastapi import APIRouter, WebSocket

from station.api.auth import Access, Authenticator
from station.api.dependencies import Viewer
from station.api.errors import ProblemError
from station.api.routes.problems import problems
from station.api.streams import StreamRequestError
from station.api.streams.request import parse_request
from station.wire import CLOSE_UNAUTHORIZED

if TYPE_CHECKING:
    from station.api.audit import Recorder
    from station.api.streams import Broadcaster
    from station.core.facade.station import Station
    from station.web.failed_logins import FailedLogins

router = APIRouter(tags=["streams"])


def access_of(websocket: WebSocket) -> Access | None:
    """Return the access that a WebSocket's ticket, token or cookie proves."""
    authenticator: Authenticator = websocket.app.state.authenticator
    ticket = websocket.query_params.get("ticket")
    if ticket is not None:
        return authenticator.redeem_ticket(ticket)
    return authenticator.access_of_headers(websocket.headers)


@router.websocket("/streams/{topic:path}")
async def stream(websocket: WebSocket, topic: str) -> None:
    """Stream a topic; refusals are close codes, which browsers only see once open."""
    station: Station = websocket.app.state.station
    broadcaster: Broadcaster = websocket.app.state.broadcaster
    failed_logins: FailedLogins = websocket.app.state.failed_logins
    recorder: Recorder = websocket.app.state.recorder
    await websocket.accept()
    access = access_of(websocket)
    if access is None:
        if "authorization" in websocket.headers:
            recorder.failed_login(websocket)
            await failed_logins.slow_down(websocket)
        reason = "The token, session or ticket is missing, unknown or too old."
        await websocket.close(CLOSE_UNAUTHORIZED, reason)
        return
    try:
        request, source = parse_request(
            station, topic, websocket.query_params, recorder.log
        )
    except StreamRequestError as error:
        await websocket.close(error.close_code, error.reason)
        return
    await broadcaster.serve(websocket, request, source, access)


@router.get(
    "/streams/{topic:path}",
    dependencies=[Viewer],
    responses=problems(426),
    response_model=None,
)
async def stream_needs_websocket(topic: str) -> NoReturn:
    """Open `ws://…/api/v1/streams/{topic}?rate=HZ&fields=a,b&format=json|msgpack`.

    Topics: `joint_states`, `controllers`, `loop`, `scene`, `events`,
    `controller_state/{name}`, `robot_state/{arm_id}`. The first frame is
    `{"topic": "hello", "boot_id", "epoch", "data": {…}}` with a snapshot of everything;
    every frame has `topic`, `seq`, `epoch`, `cycle`, `stamp`, `data`. A client that is
    slow misses frames, which gaps in `seq` show. `rate=full` sends every cycle in
    batches: `data.samples`, each with
    its `cycle`; in `data.lost` how many cycles were overwritten before they were sent,
    and in `data.skipped` how many deadlines the loop missed, so that there was no
    cycle.
    Programs send their bearer token, browsers a ticket of POST
    /api/v1/stream-tickets as `&ticket=…`. Close codes: 4400 bad request, 4401 no
    token, 4403 wrong origin, 4404 no such topic, 4408 too slow, 1001 shutting down.

    Raises:
        ProblemError: Always: this is a WebSocket.
    """
    raise ProblemError(
        426,
        "websocket_needed",
        f"'{topic}' is streamed over a WebSocket, not over plain HTTP.",
        "Open it with a WebSocket client, e.g. station.client's stream().",
        {"Upgrade": "websocket", "Connection": "Upgrade"},
    )
