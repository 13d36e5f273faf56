"""Recordings of every cycle, and the incidents that the station keeps by itself."""

from typing import TYPE_CHECKING, Annotated, Any

from anyio import to_thread
from fastapi import APIRouter, Depends, Path, Query
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, StreamingResponse

from station.api.audit import origin_of
from station.api.dependencies import Operator, ServicesDep, StationDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.core.errors import RecordingRefusedError
from station.core.facade.station import Station
from station.records.record_store import RECORDING, RecordingInfo, RecordStore
from station.wire import (
    NoteRequest,
    RecordedEvent,
    RecordedEvents,
    Recording,
    RecordingRequest,
    Recordings,
    Trajectory,
)
from station.wire.recordings import RecordingId

if TYPE_CHECKING:
    from station.records.recorder import Recorder
    from station.records.upload import Upload

MEDIA_TYPE = "application/octet-stream"
"""MCAP has no registered type; generated clients know this one."""
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
        RecordingRefusedError: This station records nothing.
    """
    if services.recorder is None:
        raise RecordingRefusedError(
            "This station records nothing.",
            remedy="Set `records.enabled` in its configuration, and install the extra "
            "`records`.",
        )
    return services.recorder


RecorderDep = Annotated[Any, Depends(get_recorder)]


async def get_incident_store(recorder: RecorderDep) -> RecordStore:
    """Return the store of incidents.

    Raises:
        RecordingRefusedError: This station keeps no incidents.
    """
    store: RecordStore | None = recorder.incidents
    if store is None:
        raise RecordingRefusedError(
            "This station keeps no incidents.",
            remedy="Set `records.incidents` in its configuration to at least 1.",
        )
    return store


IncidentsDep = Annotated[RecordStore, Depends(get_incident_store)]
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
router = APIRouter(tags=["recordings"], dependencies=[Viewer], route_class=JsonRoute)
uploads = APIRouter(tags=["recordings"], dependencies=[Viewer])
"""Of a body that is no JSON: it is a file, read as it comes."""


@router.get("/recordings", responses=problems(409))
def list_recordings(recorder: RecorderDep) -> Recordings:
    """List the recordings, the oldest first."""
    return Recordings.model_validate({"recordings": recorder.infos()})


@router.post(
    "/recordings",
    status_code=201,
    dependencies=[Operator],
    responses=problems(409, 413, 422),
)
def start_recording(
    recorder: RecorderDep, request: RecordingRequest | None = None
) -> Recording:
    """Begin to record every cycle; one recording runs at a time."""
    asked = request or RecordingRequest()
    return Recording.model_validate(recorder.start(asked.name, asked.note))


@uploads.post(
    "/recordings/upload",
    status_code=201,
    dependencies=[Operator],
    responses=problems(409, 413, 422),
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
) -> Recording:
    """Keep the MCAP file of a station, this one or another, among the recordings.

    The body is the file, 500 MB at most. One that is no whole recording is refused.
    """
    # Imported late, as in `_trajectory`.
    from station.records.upload import Upload

    upload = await to_thread.run_sync(Upload, recorder.store, name)
    try:
        await _receive(request, upload)
        pause = station.loop.right_of_way.give
        info = await to_thread.run_sync(upload.finish, pause)
    finally:
        upload.close()
    return Recording.model_validate(info)


@router.get("/recordings/{identifier}", responses=problems(404, 409, 422))
def get_recording(identifier: Id, recorder: RecorderDep) -> Recording:
    """Return the description of a recording, finished or running."""
    return Recording.model_validate(recorder.info(identifier))


@router.post(
    "/recordings/{identifier}/stop",
    dependencies=[Operator],
    responses=problems(404, 409, 422),
)
def stop_recording(identifier: Id, recorder: RecorderDep) -> Recording:
    """End a recording; its file is whole when the answer comes."""
    return Recording.model_validate(recorder.stop(identifier))


@router.delete(
    "/recordings/{identifier}",
    dependencies=[Operator],
    responses=problems(404, 409, 422),
)
def delete_recording(identifier: Id, recorder: RecorderDep) -> Recording:
    """Delete a recording that does not run; return its description."""
    return Recording.model_validate(recorder.store.delete(identifier))


@router.get(
    "/recordings/{identifier}/file",
    responses={**_FILE, **problems(404, 409, 422)},
    response_class=FileResponse,
)
def get_recording_file(identifier: Id, recorder: RecorderDep) -> FileResponse:
    """Return the MCAP file of a recording that has ended."""
    return _file(recorder.store, identifier)


@router.get(
    "/recordings/{identifier}/table",
    responses={**_TABLE, **problems(404, 409, 422)},
    response_class=StreamingResponse,
)
def get_recording_table(
    identifier: Id,
    recorder: RecorderDep,
    station: StationDep,
    channels: Channels = [],  # noqa: B006 - FastAPI copies it
    joints: Joints = [],  # noqa: B006
    rate: RowRate = None,
) -> StreamingResponse:
    """Return a recording that has ended as CSV, a row per cycle.

    A column is called after its channel, its field and what the number belongs to, e.g.
    `joint_states/position/panda_joint1`; `cycle`, `time`, `period` and `epoch` come
    first. Where a channel has no message in a cycle, it has `nan`.
    """
    return _table(recorder.store, identifier, station, channels, joints, rate)


@router.get("/recordings/{identifier}/trajectory", responses=problems(404, 409, 422))
def get_recording_trajectory(
    identifier: Id, recorder: RecorderDep, rate: Rate = 30.0
) -> Trajectory:
    """Return the joint positions of a recording that has ended, some per second."""
    return _trajectory(recorder.store, identifier, rate)


@router.get("/recordings/{identifier}/events", responses=problems(404, 409, 422))
def get_recording_events(identifier: Id, recorder: RecorderDep) -> RecordedEvents:
    """Return the events of a recording that has ended, with the notes on it."""
    return _events(recorder.store, identifier)


@router.post(
    "/recordings/{identifier}/notes",
    status_code=201,
    dependencies=[Operator],
    responses=problems(404, 409, 413, 422),
)
def add_note_to_recording(
    identifier: Id, note: NoteRequest, request: Request, recorder: RecorderDep
) -> RecordedEvent:
    """Write a note into a recording that has ended; it becomes an event of the file."""
    return _add_note(recorder, recorder.store, identifier, note, request)


@router.get("/incidents", responses=problems(409))
def list_incidents(store: IncidentsDep) -> Recordings:
    """List the incidents, the oldest first.

    The ten seconds before and the two after every stop, reflex, burst of overruns and
    fault of a controller; the oldest incidents make room for new ones.
    """
    return Recordings.model_validate({"recordings": store.infos()})


@router.get("/incidents/{identifier}", responses=problems(404, 409, 422))
def get_incident(identifier: Id, store: IncidentsDep) -> Recording:
    """Return the description of an incident."""
    return Recording.model_validate(store.info(identifier))


@router.get(
    "/incidents/{identifier}/file",
    responses={**_FILE, **problems(404, 409, 422)},
    response_class=FileResponse,
)
def get_incident_file(identifier: Id, store: IncidentsDep) -> FileResponse:
    """Return the MCAP file of an incident."""
    return _file(store, identifier)


@router.get(
    "/incidents/{identifier}/table",
    responses={**_TABLE, **problems(404, 409, 422)},
    response_class=StreamingResponse,
)
def get_incident_table(
    identifier: Id,
    store: IncidentsDep,
    station: StationDep,
    channels: Channels = [],  # noqa: B006 - FastAPI copies it
    joints: Joints = [],  # noqa: B006
    rate: RowRate = None,
) -> StreamingResponse:
    """Return an incident as CSV, as that of a recording."""
    return _table(store, identifier, station, channels, joints, rate)


@router.get("/incidents/{identifier}/trajectory", responses=problems(404, 409, 422))
def get_incident_trajectory(
    identifier: Id, store: IncidentsDep, rate: Rate = 30.0
) -> Trajectory:
    """Return the joint positions of an incident, some per second."""
    return _trajectory(store, identifier, rate)


@router.get("/incidents/{identifier}/events", responses=problems(404, 409, 422))
def get_incident_events(identifier: Id, store: IncidentsDep) -> RecordedEvents:
    """Return the events of an incident that has ended, with the notes on it."""
    return _events(store, identifier)


@router.post(
    "/incidents/{identifier}/notes",
    status_code=201,
    dependencies=[Operator],
    responses=problems(404, 409, 413, 422),
)
def add_note_to_incident(
    identifier: Id,
    note: NoteRequest,
    request: Request,
    recorder: RecorderDep,
    store: IncidentsDep,
) -> RecordedEvent:
    """Write a note into an incident that has ended; it becomes an event of the file."""
    return _add_note(recorder, store, identifier, note, request)


async def _receive(request: Request, upload: "Upload") -> None:
    """Write the body of a request to the disk as it comes.

    Raises:
        RecordingRefusedError: It ended early.
    """
    try:
        async for part in request.stream():
            await to_thread.run_sync(upload.write, part)
    except ClientDisconnect as error:
        raise RecordingRefusedError(
            "The upload ended before the end of the file.", remedy="Upload it again."
        ) from error


def _file(store: RecordStore, identifier: str) -> FileResponse:
    info = ended(store, identifier)
    return FileResponse(
        store.file(info.identifier),
        media_type=MEDIA_TYPE,
        filename=f"{info.identifier}.mcap",
    )


def _table(
    store: RecordStore,
    identifier: str,
    station: Station,
    channels: list[str],
    joints: list[str],
    rate: float | None,
) -> StreamingResponse:
    # Imported late, as in `_trajectory`.
    from station.records.export import csv_pieces
    from station.records.recording_table import Choice

    choice = Choice(tuple(channels), tuple(joints), rate)
    info = ended(store, identifier)
    # A file that cannot be read is refused here, before the answer begins.
    pause = station.loop.right_of_way.give
    pieces = csv_pieces(store.file(info.identifier), choice, pause)
    name = f'attachment; filename="{info.identifier}.csv"'
    headers = {"Content-Disposition": name}
    return StreamingResponse(pieces, media_type="text/csv", headers=headers)


def _trajectory(store: RecordStore, identifier: str, rate: float) -> Trajectory:
    # Imported late: an application without a recorder needs no reader of MCAP.
    from station.records.recording_reader import read_trajectory

    info = ended(store, identifier)
    found = read_trajectory(store.file(info.identifier)).decimated(rate)
    return Trajectory.model_validate({
        "name": list(found.names),
        "cycle": found.cycle.tolist(),
        "time": found.time.tolist(),
        "position": found.position.tolist(),
    })


def _events(store: RecordStore, identifier: str) -> RecordedEvents:
    # Imported late, as in `_trajectory`.
    from station.records.recording_events import read_events

    found = read_events(store.file(ended(store, identifier).identifier))
    return RecordedEvents.model_validate({"events": found})


def _add_note(
    recorder: "Recorder",
    store: RecordStore,
    identifier: str,
    note: NoteRequest,
    request: Request,
) -> RecordedEvent:
    found = recorder.add_note(
        store,
        ended(store, identifier).identifier,
        note.text,
        note.time,
        until=note.until,
        who=origin_of(request).who,
    )
    return RecordedEvent.model_validate(found)


def ended(store: RecordStore, identifier: str) -> RecordingInfo:
    """Return a recording that has ended, and whose file is there.

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
