"""The robot: what can be claimed, who claims it, and what limits it."""

from fastapi import APIRouter

from station.api import answers
from station.api.dependencies import StationDep, Viewer
from station.api.routes.problems import problems
from station.wire import Hardware

router = APIRouter(tags=["robot"], dependencies=[Viewer])


@router.get("/hardware", responses=problems())
def hardware(station: StationDep) -> Hardware:
    """Return interfaces, claims, limits with their sources, transmissions, clamps."""
    return answers.hardware(station.hardware())
