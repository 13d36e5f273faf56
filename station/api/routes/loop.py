"""The control loop: rate, lateness, and statistics."""

from fastapi import APIRouter

from station.api.dependencies import Operator, StationDep, Viewer
from station.api.routes.problems import problems
from station.reports import LoopReport

router = APIRouter(tags=["loop"], dependencies=[Viewer])


@router.get("/loop", responses=problems())
def loop(station: StationDep) -> LoopReport:
    """Return rate, lateness, skipped cycles and the time that each phase takes."""
    return station.loop_report()


@router.post("/loop/statistics/reset", dependencies=[Operator], responses=problems(503))
def reset_statistics(station: StationDep) -> LoopReport:
    """Start the statistics anew."""
    station.reset_loop_statistics()
    return station.loop_report()
