"""Is the process alive, does the loop run: for supervisors, without a token."""

from fastapi import APIRouter

from station.api.dependencies import StationDep
from station.api.errors import ProblemError
from station.api.routes.problems import problems
from station.wire import Health, Ready

router = APIRouter(tags=["health"])


@router.get("/health", responses=problems(503))
async def health(station: StationDep) -> Health:
    """Answer while the process lives; 503 when its control loop died: restart it.

    Raises:
        ProblemError: The control loop died.
    """
    reason = station.dead()
    if reason is not None:
        raise ProblemError(503, "loop_died", reason, "Restart the station.")
    return Health(boot_id=station.boot_id)


@router.get("/ready", responses=problems(503))
async def ready(station: StationDep) -> Ready:
    """Answer while the loop runs with fresh cycles; 503 with the reason if not.

    Raises:
        ProblemError: The loop does not run, or its last cycle is old.
    """
    reason = station.ready()
    if reason is not None:
        raise ProblemError(
            503, "not_ready", reason, "See GET /api/v1/loop for what the loop does."
        )
    return Ready()
