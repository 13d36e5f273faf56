"""The station at a glance: its state, its joints, what can be claimed, and its loop."""

import platform
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version

from fastapi import APIRouter, Request

import station as package
from station.api import answers
from station.api.dependencies import (
    ControlDep,
    EventRecorderDep,
    Operator,
    StationDep,
    Viewer,
)
from station.api.routes.problems import problems
from station.wire import Hardware, JointStates, LoopReport, Recording, Status

router = APIRouter(dependencies=[Viewer])


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Return the versions of the station and of the packages below it."""
    found = {"station": package.__version__, "python": platform.python_version()}
    for name in ("mujoco", "numpy", "fastapi", "viser"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


@router.get("/status", tags=["station"], responses=problems())
def status(
    request: Request,
    station: StationDep,
    event_recorder: EventRecorderDep,
    control: ControlDep,
) -> Status:
    """Return robot mode, epoch, stop state, loop summary and versions."""
    lease = control.present()
    owner = None if lease is None else lease.owner
    found = answers.status(station, versions(), event_recorder.log.state(), owner)
    recorder = request.app.state.recorder
    if recorder is None:
        return found
    last = recorder.last
    recording = None if last is None else Recording.model_validate(last)
    return found.model_copy(
        update={"recording": recording, "recorder_failure": recorder.failure or ""}
    )


@router.get("/joint_states", tags=["robot"], responses=problems(503))
async def joint_states(station: StationDep) -> JointStates:
    """Return positions, velocities and efforts of all joints, of the same cycle."""
    return answers.joint_states(station.latest(), station.joint_names)


@router.get("/hardware", tags=["robot"], responses=problems())
def hardware(station: StationDep) -> Hardware:
    """Return interfaces, claims, limits with their sources, transmissions, clamps."""
    return answers.hardware(station.hardware())


@router.get("/loop", tags=["loop"], responses=problems())
def loop(station: StationDep) -> LoopReport:
    """Return rate, lateness, skipped cycles and the time that each phase takes."""
    return LoopReport.model_validate(station.loop_report())


@router.post(
    "/loop/statistics/reset",
    tags=["loop"],
    dependencies=[Operator],
    responses=problems(503),
)
def reset_statistics(station: StationDep) -> LoopReport:
    """Start the statistics anew."""
    station.reset_loop_statistics()
    return LoopReport.model_validate(station.loop_report())
