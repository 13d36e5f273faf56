"""The things around a simulated robot."""

from fastapi import APIRouter

from station.api.dependencies import StationDep, Viewer
from station.api.routes.problems import problems
from station.wire import Scene

router = APIRouter(tags=["simulation"], dependencies=[Viewer])


@router.get("/scene", responses=problems(503))
def scene(station: StationDep) -> Scene:
    """Return the things around the robots, what touches what, and moving bases."""
    return Scene.model_validate({
        "objects": station.scene(),
        "contacts": station.contacts(),
        "bases": station.bases(),
    })
