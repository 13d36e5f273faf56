"""The station at a glance."""

import platform
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version

from fastapi import APIRouter

import station as package
from station.api import answers
from station.api.dependencies import ControlDep, RecorderDep, StationDep, Viewer
from station.api.routes.problems import problems
from station.wire import Status

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
def status(station: StationDep, recorder: RecorderDep, control: ControlDep) -> Status:
    """Return robot mode, epoch, stop state, loop summary and versions."""
    lease = control.present()
    owner = None if lease is None else lease.owner
    return answers.status(station, versions(), recorder.log.state(), owner)
