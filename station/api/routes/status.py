"""The station at a glance."""

import platform
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version

from fastapi import APIRouter

import station as package
from station.api import answers
from station.api.dependencies import ServicesDep, Viewer
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
    services: ServicesDep,
) -> Status:
    """Return robot mode, epoch, stop state, loop summary and versions."""
    lease = services.control.present()
    owner = None if lease is None else lease.owner
    log = services.event_recorder.log
    found = answers.status(services.station, versions(), log.state(), owner)
    recorder = services.recorder
    if recorder is None:
        return found
    last = recorder.last
    recording = None if last is None else Recording.model_validate(last)
    return found.model_copy(
        update={"recording": recording, "recorder_failure": recorder.failure or ""}
    )
