"""Is the process alive, does the loop run: for supervisors, without a token."""

from fastapi import APIRouter

from station.api.dependencies import StationDep
from station.api.errors import ProblemError
from station.api.routes.problems import problems
from station.wire import Health, Ready

router = APIRouter(tags=["health"])


@router.get("/health", responses=problems(503))
async def health(station: StationDep) -> Health:
    """Say that the process lives; 503 when its control loop died: restart it then.

    Raises:
        ProblemError: The control loop died.
    """
    reason = station.dead()
    if reason:
        raise ProblemError(503, "loop_died", reason, "Restart the station.")
    return Health(boot_id=station.boot_id)


@router.get("/ready", responses=problems(503))
async def ready(station: StationDep) -> Ready:
    """Say that the loop runs and its last cycle is fresh; 503 with the reason if not.

    Raises:
        ProblemError: It does not.
    """
    reason = station.ready()
    if reason:
        raise ProblemError(
            503, "not_ready", reason, "See GET /api/v1/loop for what the loop does."
        )
    return Ready()
