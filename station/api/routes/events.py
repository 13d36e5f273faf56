"""Events, in pages or as an endless answer, and alarms, which need a person."""

from typing import Annotated

from fastapi import Header, Path, Query, Request
from fastapi.responses import StreamingResponse

from station.api import answers
from station.api.audit import origin_of
from station.api.auth import until_first
from station.api.dependencies import AccessDep, ServicesDep
from station.api.event_feed import MEDIA_TYPE
from station.api.routes.routing import change, problems, routes_of
from station.events import EventKind, Severity
from station.wire import Alarm, Alarms, EventKindName, Events, SeverityName

MAX_PAGE = 1000
"""Most events of one answer."""

router = routes_of("events")

Since = Annotated[
    int | None,
    Query(
        ge=0,
        le=2**53,
        description="Number of the last event that the caller has; the newest events "
        "when left out.",
        examples=[17],
    ),
]
Kinds = Annotated[
    list[EventKindName] | None,
    Query(
        description="Only events of this kind; may be repeated.", examples=[["stop"]]
    ),
]
LeastSeverity = Annotated[
    SeverityName,
    Query(description="Only events of at least this severity.", examples=["warning"]),
]
Limit = Annotated[
    int,
    Query(ge=1, le=MAX_PAGE, description="Most events, 1 to 1000.", examples=[100]),
]
LastEventId = Annotated[
    str | None,
    Header(
        pattern=r"^\d{1,15}$",
        description="With server-sent events: number of the last event received.",
        examples=["17"],
    ),
]


@router.get(
    "/events",
    response_model=Events,
    responses={
        200: {"content": {MEDIA_TYPE: {"schema": {"type": "string"}}}},
        **problems(422, 503),
    },
)
async def get_events(
    request: Request,
    access: AccessDep,
    services: ServicesDep,
    since: Since = None,
    kind: Kinds = None,
    severity: LeastSeverity = "info",
    limit: Limit = 100,
    last_event_id: LastEventId = None,
) -> Events | StreamingResponse:
    """Return events, oldest first: the newest ones, or those after `since`.

    With `Accept: text/event-stream` the answer does not end: it sends every new event
    as a server-sent event with `id`, `event` (the kind) and `data`. A client that
    connects again with `Last-Event-ID` misses no event.
    """
    feed, closing = services.event_feed, services.broadcaster.wait_closing
    kinds = [EventKind(each) for each in kind or []]
    least = Severity(severity)
    if MEDIA_TYPE in request.headers.get("accept", ""):
        after = since if last_event_id is None else int(last_event_id)
        lines = feed.follow(
            after, kinds, least, lambda: until_first(access.wait_for_end(), closing())
        )
        return StreamingResponse(lines, media_type=MEDIA_TYPE)
    found = await feed.page(since, limit, kinds, least)
    return Events(
        events=found,
        newest_id=services.event_recorder.log.newest_id,
    )


Number = Annotated[
    int, Path(ge=1, le=2**53, description="Number of the alarm.", examples=[3])
]


@router.get("/alarms", responses=problems())
def list_alarms(services: ServicesDep) -> Alarms:
    """List the alarms, newest first.

    An alarm leaves the list when its cause is gone and a person has acknowledged it, in
    either order.
    """
    found = [answers.alarm(each) for each in services.alarms.all()]
    unseen = sum(each.acknowledged_at is None for each in found)
    return Alarms(alarms=found, unacknowledged=unseen)


@router.post("/alarms/{number}/acknowledge", **change(404, 422))
def acknowledge_alarm(number: Number, request: Request, services: ServicesDep) -> Alarm:
    """Acknowledge an alarm, under the name of the caller's token.

    This ends no cause and moves nothing. A second acknowledgement changes nothing.
    """
    services.alarms.look()
    return answers.alarm(services.alarms.acknowledge(number, origin_of(request)))
