"""Pause, step, reset and the pace of a simulated robot, and the scene around it."""

from typing import Annotated

from fastapi import APIRouter, Path

from station.api.dependencies import Operator, ServicesDep, StationDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.reports import SavedScene, Simulation
from station.wire import (
    AttachRequest,
    DetachRequest,
    ResetRequest,
    SavedScenes,
    Scene,
    SceneObject,
    SceneObjectRequest,
    SimulationPatch,
    StepRequest,
)
from station.wire.base import FileName

router = APIRouter(tags=["simulation"], dependencies=[Viewer], route_class=JsonRoute)
ObjectName = Annotated[
    str, Path(description="Name of the object.", examples=["wall"], max_length=128)
]
SceneName = Annotated[
    FileName, Path(description="Name of the scene.", examples=["cell"])
]
_CHANGE = problems(409, 413, 422, 503)


@router.get("/simulation", responses=problems(409))
def get_simulation(station: StationDep) -> Simulation:
    """Return whether simulated time passes, and how fast."""
    return station.simulation.report()


@router.patch("/simulation", dependencies=[Operator], responses=_CHANGE)
def patch_simulation(request: SimulationPatch, station: StationDep) -> Simulation:
    """Pause, resume or change the pace. Stops and switches work while it is paused."""
    return station.simulation.change(
        paused=request.paused, real_time_factor=request.real_time_factor
    )


@router.post("/simulation/step", dependencies=[Operator], responses=_CHANGE)
def step(station: StationDep, request: StepRequest | None = None) -> Simulation:
    """Run some cycles of a paused simulation; answers when they are done."""
    return station.simulation.step((request or StepRequest()).n)


@router.post("/simulation/reset", dependencies=[Operator], responses=_CHANGE)
def reset(station: StationDep, request: ResetRequest | None = None) -> Simulation:
    """Put the world back to its start, or to a keyframe of the robot.

    Running controllers start anew from there. Earlier set-points and goals are void.
    """
    asked = request or ResetRequest()
    return station.simulation.reset(asked.joint_positions, asked.keyframe)


@router.get("/scene", responses=problems(503))
def scene(station: StationDep) -> Scene:
    """Return the objects around the robots, contacts and moving bases."""
    return Scene.model_validate({
        "objects": station.scene(),
        "contacts": station.contacts(),
        "bases": station.bases(),
        "clearances": station.surroundings.clearances(),
    })


@router.put(
    "/scene/{name}", dependencies=[Operator], responses=problems(409, 413, 422, 503)
)
def put_scene_object(
    name: ObjectName, request: SceneObjectRequest, station: StationDep
) -> SceneObject:
    """Add an object with a role, or change, move or drag the one of that name."""
    values = request.model_dump(exclude_unset=True)
    return SceneObject.model_validate(station.surroundings.put(name, values))


@router.delete(
    "/scene/{name}", dependencies=[Operator], responses=problems(404, 409, 503)
)
def delete_scene_object(name: ObjectName, station: StationDep) -> Scene:
    """Remove an object with a role; answers with what is left."""
    station.surroundings.remove(name)
    return scene(station)


@router.post(
    "/scene/{name}/attach",
    dependencies=[Operator],
    responses=problems(404, 409, 413, 422, 503),
)
def attach_scene_object(
    name: ObjectName, station: StationDep, request: AttachRequest | None = None
) -> SceneObject:
    """Let an arm carry an object: it moves with the hand and is guarded as its part.

    The arm is told the load, so it must not move. A simulated body stays a body: the
    fingers have to hold it.
    """
    asked = request or AttachRequest()
    found = station.surroundings.attach(name, asked.arm, load=asked.load)
    return SceneObject.model_validate(found)


@router.post(
    "/scene/{name}/detach",
    dependencies=[Operator],
    responses=problems(404, 409, 413, 422, 503),
)
def detach_scene_object(
    name: ObjectName, station: StationDep, request: DetachRequest | None = None
) -> SceneObject:
    """Let an object that an arm carries stay where it is now."""
    asked = request or DetachRequest()
    found = station.surroundings.detach(name, load=asked.load)
    return SceneObject.model_validate(found)


@router.get("/scenes", responses=problems())
def list_scenes(services: ServicesDep) -> SavedScenes:
    """List the saved scenes."""
    return SavedScenes(scenes=services.scenes.names())


@router.get("/scenes/{name}", responses=problems(404, 422))
def get_saved_scene(name: SceneName, services: ServicesDep) -> SavedScene:
    """Return a saved scene with its objects."""
    return services.scenes.get(name)


@router.put("/scenes/{name}", dependencies=[Operator], responses=problems(404, 422))
def save_scene(
    name: SceneName, services: ServicesDep, station: StationDep
) -> SavedScene:
    """Save the objects that have a role now; a scene of that name is replaced.

    Solid objects and what an arm carries are left out.
    """
    return services.scenes.save(name, station.surroundings.entries())


@router.post(
    "/scenes/{name}/load",
    dependencies=[Operator],
    responses=problems(404, 409, 422, 503),
)
def load_scene(name: SceneName, services: ServicesDep, station: StationDep) -> Scene:
    """Replace the objects with a role by those of a saved scene."""
    station.surroundings.replace_roles(services.scenes.get(name).objects)
    return scene(station)


@router.delete("/scenes/{name}", dependencies=[Operator], responses=problems(404, 422))
def delete_saved_scene(name: SceneName, services: ServicesDep) -> SavedScene:
    """Delete a saved scene; return its last content."""
    return services.scenes.delete(name)
