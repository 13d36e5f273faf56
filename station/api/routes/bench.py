"""The bench: measure responses of joints, keep them as runs, and check lessons on it.

Parts of recordings are read as runs. A lesson is an exercise that the station checks on
the student's own run.
"""

from functools import partial
from typing import TYPE_CHECKING, Annotated

import numpy as np
from fastapi import Path, Query

from station.api.auth import Role
from station.api.dependencies import AccessDep, LeaseKey, ServicesDep
from station.api.routes.recordings import Id, StoreDep, both, ended
from station.api.routes.routing import change, problems, routes_of
from station.api.services import Services
from station.core.errors import RecordingRefusedError, suggest
from station.trials.bench_analysis import excitation_of_part, joint_test
from station.trials.trace import Trace
from station.wire.base import FileName
from station.wire.excitations import (
    BenchRequest,
    BenchResponse,
    BenchRuns,
    Lesson,
    LessonBeginRequest,
    LessonCheckRequest,
    LessonResult,
    Lessons,
    PartRequest,
)

if TYPE_CHECKING:
    from station.records.record_store import RecordStore

_LONGEST_PART = 120_000
"""Most cycles in a part of a recording that is read as a test."""
_STATES = ("position", "velocity", "effort")
router = routes_of("bench")
RunName = Annotated[FileName, Path(description="Name of the run.", examples=["soft"])]
lessons = routes_of("lessons", "/lessons")
LessonName = Annotated[
    FileName, Path(description="Name of the lesson.", examples=["damping"])
]
Person = Annotated[
    str,
    Query(
        max_length=100,
        description="Person whose progress is told; the bearer of the token if empty.",
        examples=["ada"],
    ),
]


@router.post("/controllers/{name}/bench", **change(404, 409, 413, 422, 423))
def measure_response(
    name: str,
    request: BenchRequest,
    services: ServicesDep,
    access: AccessDep,
    key: LeaseKey = None,
) -> BenchResponse:
    """Excite one joint through a running controller, and return its response.

    The answer comes when the joint is back at its initial position, and is kept as a
    run. Before anything moves, the station checks the size and rate of the excitation,
    and its distance from the joint's limits. A stop, a loss of control, or a joint that
    leaves the envelope ends the measurement.
    """
    if access.role is Role.AGENT:
        services.rehearsals.check_range(
            request.excitation.joint, request.excitation.amplitude
        )
    admit = partial(services.control.admit, access, key, name, is_bounded=True)
    found = services.bench.measure(name, request, admit)
    return services.bench_runs.keep(found, request.name)


@router.get("/bench-runs", responses=problems())
def list_bench_runs(services: ServicesDep) -> BenchRuns:
    """List the kept runs with their metrics, the oldest first."""
    return BenchRuns(runs=services.bench_runs.list())


@router.get("/bench-runs/{name}", responses=problems(404, 422))
def get_bench_run(name: RunName, services: ServicesDep) -> BenchResponse:
    """Return a run with its curves."""
    return services.bench_runs.get(name)


@router.delete("/bench-runs/{name}", **change(404, 422))
def delete_bench_run(name: RunName, services: ServicesDep) -> BenchResponse:
    """Delete a run; return it."""
    return services.bench_runs.delete(name)


@both(router, "POST", "bench", "measure_{}", **change(404, 409, 413, 422))
def measure_part(
    identifier: Id, part: PartRequest, store: StoreDep, services: ServicesDep
) -> BenchResponse:
    """Read a part of a recording or an incident as a test of a joint; keep the run."""
    trace = _trace(store, identifier, part, services)
    excitation, script, trace = excitation_of_part(part, trace)
    # A recording has no channel of gains.
    limits = services.station.loop.hw.joint_limits()
    found = joint_test(trace, excitation, script, {}, limits)
    return services.bench_runs.keep(found, part.name)


def _trace(
    store: "RecordStore", identifier: str, part: PartRequest, services: Services
) -> Trace:
    """Return the motion of a joint in a part of a recording.

    Raises:
        RecordingRefusedError: The recording has no such joint or controller, or the
            part has no cycle, too many cycles, or a gap.
        RecordingFileError: The file is not a complete recording.
    """
    # Imported late, because an application without a recorder needs no MCAP reader.
    from station.records.cycle_messages import CONTROLLERS, JOINT_STATES
    from station.records.recording_table import Choice, RecordingTable

    info = ended(store, identifier)
    controller = f"{CONTROLLERS}{part.controller}"
    choice = Choice((JOINT_STATES, controller), (part.joint,))
    pause = services.station.loop.cycle_yield.wait_if_cycle_is_due
    table = RecordingTable(store.file(info.identifier), choice, pause)
    joints, samples = JOINT_STATES.strip("/"), controller.strip("/")
    wanted = ["cycle", "time", "period"]
    wanted += [f"{joints}/{each}/{part.joint}" for each in _STATES]
    wanted += [f"{samples}/{each}/{part.joint}" for each in ("desired", "output")]
    for name in wanted:
        if name not in table.names:
            raise RecordingRefusedError(
                f"The recording '{info.identifier}' has no column '{name}'.",
                remedy=suggest(name, table.names),
                details={"column": name},
            )
    columns = [table.names.index(name) for name in wanted]
    begin = -np.inf if part.begin is None else part.begin
    end = np.inf if part.end is None else part.end
    rows = []
    for row in table.rows():
        if begin <= row[columns[1]] <= end and row[columns[6]] == row[columns[6]]:
            rows.append([row[column] for column in columns])
            if len(rows) > _LONGEST_PART:
                break
    if not 2 <= len(rows) <= _LONGEST_PART or rows[-1][0] - rows[0][0] >= len(rows):
        raise RecordingRefusedError(
            f"The part of '{info.identifier}' has {len(rows)} cycles in which "
            f"'{part.controller}' commanded '{part.joint}'; a test has 2 to "
            f"{_LONGEST_PART}, without a gap.",
            remedy="Choose `begin` and `end` within one run of the controller.",
        )
    values = np.array(rows)
    position, velocity, effort, desired, output = values[:, 3:].T[:, :, None]
    return Trace(
        joints=(part.joint,),
        period=float(np.median(values[:, 2])),
        time=values[:, 1] - values[0, 1],
        position=position,
        velocity=velocity,
        effort=effort,
        desired=desired,
        error=desired - position,
        output=output,
    )


@lessons.get("", responses=problems(422))
def list_lessons(
    services: ServicesDep, access: AccessDep, person: Person = ""
) -> Lessons:
    """List the lessons in their order, with the progress of a person."""
    return services.lessons.lessons(person or access.name)


@lessons.post("/{name}/begin", **change(404, 413, 422))
def begin_lesson(
    name: LessonName,
    request: LessonBeginRequest,
    services: ServicesDep,
    access: AccessDep,
) -> Lesson:
    """Begin a lesson; the station watches the robot from now on."""
    return services.lessons.begin(name, request.person or access.name)


@lessons.post("/{name}/check", **change(404, 409, 413, 422))
def check_lesson(
    name: LessonName,
    request: LessonCheckRequest,
    services: ServicesDep,
    access: AccessDep,
) -> LessonResult:
    """Check the robot's motions since the lesson was begun; the attempt goes on."""
    person = request.person or access.name
    return services.lessons.check(name, person, request.answers)
