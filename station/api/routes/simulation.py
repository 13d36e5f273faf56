"""Pause, step, reset and the pace of a simulated robot, and the scene around it."""

from typing import Annotated

from fastapi import APIRouter, Path

from station import wire
from station.api.dependencies import StationDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import change, problems
from station.reports import Simulation

router = APIRouter(tags=["simulation"], dependencies=[Viewer], route_class=JsonRoute)
ObjectName = Annotated[
    str, Path(description="Name of the object.", examples=["wall"], max_length=128)
]
_CHANGE = change(409, 413, 422, 503)


@router.get("/simulation", responses=problems(409))
def get_simulation(station: StationDep) -> Simulation:
    """Return whether simulated time passes, and how fast."""
    return station.simulation.report()


@router.patch("/simulation", **_CHANGE)
def patch_simulation(request: wire.SimulationPatch, station: StationDep) -> Simulation:
    """Pause, resume or change the pace. Stops and switches work while it is paused."""
    return station.simulation.change(
        paused=request.paused, real_time_factor=request.real_time_factor
    )


@router.post("/simulation/step", **_CHANGE)
def step(station: StationDep, request: wire.StepRequest | None = None) -> Simulation:
    """Run some cycles of a paused simulation; answers when they are done."""
    return station.simulation.step((request or wire.StepRequest()).n)


@router.post("/simulation/reset", **_CHANGE)
def reset(station: StationDep, request: wire.ResetRequest | None = None) -> Simulation:
    """Put the world back to its start, or to a keyframe of the robot.

    Running controllers start anew from there. Earlier set-points and goals are void.
    """
    asked = request or wire.ResetRequest()
    return station.simulation.reset(asked.joint_positions, asked.keyframe)


@router.get("/scene", responses=problems(503))
def scene(station: StationDep) -> wire.Scene:
    """Return the objects around the robots, contacts and moving bases."""
    return wire.Scene.model_validate({
        "objects": station.scene(),
        "contacts": station.contacts(),
        "bases": station.bases(),
        "clearances": station.surroundings.clearances(),
    })


@router.put("/scene/{name}", **change(409, 413, 422, 503))
def put_scene_object(
    name: ObjectName, request: wire.SceneObjectRequest, station: StationDep
) -> wire.SceneObject:
    """Add an object with a role, or change, move or drag the one of that name."""
    values = request.model_dump(exclude_unset=True)
    return wire.SceneObject.model_validate(station.surroundings.put(name, values))


@router.delete("/scene/{name}", **change(404, 409, 503))
def delete_scene_object(name: ObjectName, station: StationDep) -> wire.Scene:
    """Remove an object with a role; answers with what is left."""
    station.surroundings.remove(name)
    return scene(station)
