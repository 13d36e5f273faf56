"""The station at a glance."""

import platform
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version

from fastapi import APIRouter, Request

import station as package
from station.api import answers
from station.api.dependencies import ControlDep, EventRecorderDep, StationDep, Viewer
from station.api.routes.problems import problems
from station.wire import Recording, Status

router = APIRouter(tags=["station"], dependencies=[Viewer])


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


@router.get("/status", responses=problems())
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
