"""The latched stop. A software stop, not a safety device.

Stopping runs in the event loop itself, so that no other request, however many there
are and however long they take, makes a stop wait.
"""

from fastapi import APIRouter

from station.api import wire
from station.api.dependencies import Operator, RoleDep, StationDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.api.schemas import ReleaseRequest, StopRequest, StopState

router = APIRouter(tags=["stop"], dependencies=[Viewer], route_class=JsonRoute)


@router.get("/stop", responses=problems())
async def get_stop(station: StationDep) -> StopState:
    """Return the state of the stop."""
    return wire.stop_state(station)


@router.post("/stop", responses=problems(413, 422))
async def stop(
    station: StationDep, role: RoleDep, request: StopRequest | None = None
) -> StopState:
    """Stop every controller in the next cycle; anybody with a token may.

    Stopping again is fine. Nothing moves until the stop is released and armed.
    """
    reason = request.reason if request is not None else ""
    station.stop(reason or f"asked for by the {role.value}")
    return wire.stop_state(station)


@router.post(
    "/stop/release", dependencies=[Operator], responses=problems(413, 422, 423)
)
def release_stop(
    station: StationDep, request: ReleaseRequest | None = None
) -> StopState:
    """Release the stop; a second time with `arm` to allow motion again.

    Nothing resumes by itself: controllers must be started again.
    """
    station.release_stop(arm=request is not None and request.arm)
    return wire.stop_state(station)
