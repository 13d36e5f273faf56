"""Recordings of every cycle, and incidents, which the station keeps by itself."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from anyio import to_thread
from fastapi import Depends, Path, Query
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, StreamingResponse

from station import wire
from station.api.audit import origin_of
from station.api.dependencies import ServicesDep, StationDep, Viewer
from station.api.json_route import QueryRoute
from station.api.routes.routing import ApiRouter, change, problems, routes_of
from station.core.errors import RecordingRefusedError
from station.records.record_store import RECORDING, RecordingInfo, RecordStore
from station.wire.protocol import PREFIX
from station.wire.records import RecordingId

if TYPE_CHECKING:
    from station.records.recorder import Recorder
    from station.records.upload import Upload

EndpointT = TypeVar("EndpointT", bound=Callable[..., object])
MEDIA_TYPE = "application/octet-stream"
"""Media type of files: MCAP has no registered type, and generated clients know this
one."""
Id = Annotated[
    RecordingId,
    Path(
        description="Id of the recording, as its start answered; or the name that it "
        "was given, if no other one has it.",
        examples=["20261122T091500123-walk"],
    ),
]
Rate = Annotated[
    float,
    Query(
        gt=0.0,
        le=1000.0,
        description="Cycles per second of station time [Hz].",
        examples=[30.0],
    ),
]

Channels = Annotated[
    list[str],
    Query(
        max_length=100,
        description="Channels, or channels with a field, such as "
        "`joint_states/position`; all when left out.",
        examples=[["joint_states", "commands/effort"]],
    ),
]
Joints = Annotated[
    list[str],
    Query(
        max_length=100,
        description="Joints, or other elements with a name; all when left out.",
        examples=[["panda_joint1"]],
    ),
]
RowRate = Annotated[
    float | None,
    Query(
        gt=0.0,
        le=10_000.0,
        description="Rows per second of station time [Hz]; every cycle when left out.",
        examples=[100.0],
    ),
]


async def get_recorder(services: ServicesDep) -> "Recorder":
    """Return the recorder of the station.

    Raises:
        RecordingRefusedError: This station has no recordings.
    """
    if services.recorder is None:
        raise RecordingRefusedError(
            "This station records nothing.",
            remedy="Set `records.enabled` in its configuration, and install the extra "
            "`records`.",
        )
    return services.recorder


RecorderDep = Annotated[Any, Depends(get_recorder)]


async def get_store(request: Request, recorder: RecorderDep) -> RecordStore:
    """Return the store of the request's path: recordings or incidents.

    Raises:
        RecordingRefusedError: This station keeps no incidents.
    """
    is_incident = request.url.path.startswith(f"{PREFIX}/incidents")
    store: RecordStore | None = recorder.incidents if is_incident else recorder.store
    if store is None:
        raise RecordingRefusedError(
            "This station keeps no incidents.",
            remedy="Set `records.incidents` in its configuration to at least 1.",
        )
    return store


StoreDep = Annotated[RecordStore, Depends(get_store)]
_FILE: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The MCAP file.",
        "content": {MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}},
    }
}
_TABLE: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The table, a row per cycle.",
        "content": {"text/csv": {"schema": {"type": "string"}}},
    }
}
router = routes_of("recordings")
uploads = ApiRouter(tags=["recordings"], dependencies=[Viewer], route_class=QueryRoute)
"""Route whose body is not JSON but a file, which is read as it comes."""


@router.get("/recordings", responses=problems(409))
def list_recordings(recorder: RecorderDep) -> wire.Recordings:
    """List the recordings, the oldest first."""
    return wire.Recordings.model_validate({"recordings": recorder.infos()})


@router.post("/recordings", status_code=201, **change(409, 413, 422))
def start_recording(
    recorder: RecorderDep, request: wire.RecordingRequest | None = None
) -> wire.Recording:
    """Begin to record every cycle; one recording runs at a time."""
    asked = request or wire.RecordingRequest()
    return wire.Recording.model_validate(recorder.start(asked.name, asked.note))


@uploads.post(
    "/recordings/upload",
    status_code=201,
    **change(409, 413, 422),
    openapi_extra={
        "requestBody": {
            "required": True,
            "description": "The MCAP file.",
            "content": {MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}},
        }
    },
)
async def upload_recording(
    request: Request,
    recorder: RecorderDep,
    station: StationDep,
    name: Annotated[
        str,
        Query(
            max_length=80,
            pattern=r"^([A-Za-z0-9_][A-Za-z0-9_.-]*)?$",
            description="Name of the recording; may be empty.",
            examples=["tuesday"],
        ),
    ] = "",
) -> wire.Recording:
    """Add the MCAP file of this or another station to the recordings.

    The body is the file, 500 MB at most. A file that is not a complete recording is
    refused.
    """
    # Imported late, as in `get_trajectory`.
    from station.records.upload import Upload

    upload = await to_thread.run_sync(Upload, recorder.store, name)
    try:
        await _receive(request, upload)
        pause = station.loop.cycle_yield.wait_if_cycle_is_due
        info = await to_thread.run_sync(upload.finish, pause)
    finally:
        upload.close()
    return wire.Recording.model_validate(info)


@router.get("/recordings/{identifier}", responses=problems(404, 409, 422))
def get_recording(identifier: Id, recorder: RecorderDep) -> wire.Recording:
    """Return the description of an ended or running recording."""
    return wire.Recording.model_validate(recorder.info(identifier))


@router.post("/recordings/{identifier}/stop", **change(404, 409, 422))
def stop_recording(identifier: Id, recorder: RecorderDep) -> wire.Recording:
    """End a recording; its file is complete when the answer comes."""
    return wire.Recording.model_validate(recorder.stop(identifier))


@router.delete("/recordings/{identifier}", **change(404, 409, 422))
def delete_recording(identifier: Id, recorder: RecorderDep) -> wire.Recording:
    """Delete an ended recording; return its description."""
    return wire.Recording.model_validate(recorder.store.delete(identifier))


@router.get("/incidents", responses=problems(409))
def list_incidents(store: StoreDep) -> wire.Recordings:
    """List the incidents, the oldest first.

    An incident has the ten seconds before and the two seconds after a stop, a reflex, a
    burst of overruns or a fault of a controller. New incidents replace the oldest ones.
    """
    return wire.Recordings.model_validate({"recordings": store.infos()})


@router.get("/incidents/{identifier}", responses=problems(404, 409, 422))
def get_incident(identifier: Id, store: StoreDep) -> wire.Recording:
    """Return the description of an incident."""
    return wire.Recording.model_validate(store.info(identifier))


def both(
    routes: ApiRouter,
    method: str,
    path: str,
    name: str,
    **options: Any,  # noqa: ANN401 - those of the framework
) -> Callable[[EndpointT], EndpointT]:
    """Return a decorator that adds a route for recordings and one for incidents.

    Args:
        routes: Router that gets the routes.
        method: HTTP method.
        path: Path below that of the recording or the incident.
        name: Name of the operation, with `{}` for the noun.
        options: Options of the framework.
    """

    def add(endpoint: EndpointT) -> EndpointT:
        for noun in ("recording", "incident"):
            routes.add_api_route(
                f"/{noun}s/{{identifier}}/{path}",
                endpoint,
                methods=[method],
                name=name.format(noun),
                **options,
            )
        return endpoint

    return add


@both(
    router,
    "GET",
    "file",
    "get_{}_file",
    responses={**_FILE, **problems(404, 409, 422)},
    response_class=FileResponse,
)
def get_file(identifier: Id, store: StoreDep) -> FileResponse:
    """Return the MCAP file of an ended recording or incident."""
    info = ended(store, identifier)
    return FileResponse(
        store.file(info.identifier),
        media_type=MEDIA_TYPE,
        filename=f"{info.identifier}.mcap",
    )


@both(
    router,
    "GET",
    "table",
    "get_{}_table",
    responses={**_TABLE, **problems(404, 409, 422)},
    response_class=StreamingResponse,
)
def get_table(
    identifier: Id,
    store: StoreDep,
    station: StationDep,
    channels: Channels = [],  # noqa: B006 - FastAPI copies it
    joints: Joints = [],  # noqa: B006
    rate: RowRate = None,
) -> StreamingResponse:
    """Return an ended recording or incident as CSV, with one row per cycle.

    The name of a column has the channel, the field, and the joint or axis, e.g.
    `joint_states/position/panda_joint1`; `cycle`, `time`, `period` and `epoch` come
    first. Columns of a channel without a message in a cycle have `nan`.
    """
    # Imported late, as in `get_trajectory`.
    from station.records.recording_table import Choice, csv_pieces

    choice = Choice(tuple(channels), tuple(joints), rate)
    info = ended(store, identifier)
    # This call refuses an unreadable file, before the answer begins.
    pause = station.loop.cycle_yield.wait_if_cycle_is_due
    pieces = csv_pieces(store.file(info.identifier), choice, pause)
    name = f'attachment; filename="{info.identifier}.csv"'
    headers = {"Content-Disposition": name}
    return StreamingResponse(pieces, media_type="text/csv", headers=headers)


@both(
    router, "GET", "trajectory", "get_{}_trajectory", responses=problems(404, 409, 422)
)
def get_trajectory(
    identifier: Id, store: StoreDep, rate: Rate = 30.0
) -> wire.Trajectory:
    """Return the joint positions of an ended recording or incident."""
    # Imported late, because an application without a recorder needs no MCAP reader.
    from station.records.recording_reader import read_trajectory

    info = ended(store, identifier)
    found = read_trajectory(store.file(info.identifier)).decimated(rate)
    return wire.Trajectory.model_validate({
        "name": list(found.names),
        "cycle": found.cycle.tolist(),
        "time": found.time.tolist(),
        "position": found.position.tolist(),
    })


@both(router, "GET", "events", "get_{}_events", responses=problems(404, 409, 422))
def get_events(identifier: Id, store: StoreDep) -> wire.RecordedEvents:
    """Return the events of an ended recording or incident, with its notes."""
    # Imported late, as in `get_trajectory`.
    from station.records.recording_events import read_events

    found = read_events(store.file(ended(store, identifier).identifier))
    return wire.RecordedEvents.model_validate({"events": found})


@both(
    router,
    "POST",
    "notes",
    "add_note_to_{}",
    status_code=201,
    **change(404, 409, 413, 422),
)
def add_note(
    identifier: Id,
    note: wire.NoteRequest,
    request: Request,
    recorder: RecorderDep,
    store: StoreDep,
) -> wire.RecordedEvent:
    """Add a note to a recording or an incident, where it becomes an event."""
    found = recorder.add_note(
        store,
        ended(store, identifier).identifier,
        note.text,
        note.time,
        until=note.until,
        who=origin_of(request).who,
    )
    return wire.RecordedEvent.model_validate(found)


def ended(store: RecordStore, identifier: str) -> RecordingInfo:
    """Return an ended recording whose file exists.

    Raises:
        RecordingRefusedError: The recording is not finished, or its file is gone.
    """
    info = store.info(identifier)
    if info.state == RECORDING:
        raise RecordingRefusedError(
            f"'{info.identifier}' is being recorded; its file is not whole yet.",
            remedy="Stop it first.",
            details={"id": info.identifier},
        )
    if not store.file(info.identifier).is_file():
        raise RecordingRefusedError(
            f"The file of '{info.identifier}' is gone.",
            remedy="Somebody has deleted it; delete the recording, too.",
            details={"id": info.identifier},
        )
    return info


async def _receive(request: Request, upload: "Upload") -> None:
    """Write the body of a request to the disk as it comes.

    Raises:
        RecordingRefusedError: The body ended early.
    """
    try:
        async for part in request.stream():
            await to_thread.run_sync(upload.write, part)
    except ClientDisconnect as error:
        raise RecordingRefusedError(
            "The upload ended before the end of the file.", remedy="Upload it again."
        ) from error
