"""Pause, step, reset and speed of a simulated robot, and the scene around it."""

from typing import Annotated

from fastapi import Path

from station import wire
from station.api.dependencies import ServicesDep, StationDep
from station.api.routes.routing import change, problems, routes_of
from station.core.description.urdf import Pose
from station.reports import SavedScene, Simulation
from station.wire.base import FileName

router = routes_of("simulation")
ObjectName = Annotated[
    str, Path(description="Name of the object.", examples=["wall"], max_length=128)
]
SceneName = Annotated[
    FileName, Path(description="Name of the scene.", examples=["cell"])
]
_CHANGE = change(409, 413, 422, 503)


@router.get("/simulation", responses=problems(409))
def get_simulation(station: StationDep) -> Simulation:
    """Return the state of simulated time: paused or not, and its speed."""
    return station.simulation.report()


@router.patch("/simulation", **_CHANGE)
def patch_simulation(request: wire.SimulationPatch, station: StationDep) -> Simulation:
    """Pause, resume or change the speed. Stops and switches also work in a pause."""
    return station.simulation.change(
        paused=request.paused, real_time_factor=request.real_time_factor
    )


@router.post("/simulation/step", **_CHANGE)
def step(station: StationDep, request: wire.StepRequest | None = None) -> Simulation:
    """Run some cycles of a paused simulation; answer when they are done."""
    return station.simulation.step((request or wire.StepRequest()).n)


@router.post("/simulation/reset", **_CHANGE)
def reset(station: StationDep, request: wire.ResetRequest | None = None) -> Simulation:
    """Put the world back to its start, or to a keyframe of the robot.

    Running controllers start again from there. Earlier set-points and goals are void.
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
    """Add an object with a role, or change, move or drag an object of that name."""
    values = request.model_dump(exclude_unset=True)
    if request.orientation is not None:
        x, y, z, w = values.pop("orientation")
        values["rpy"] = [*Pose(quaternion=(w, x, y, z)).rpy()]
    return wire.SceneObject.model_validate(station.surroundings.put(name, values))


@router.delete("/scene/{name}", **change(404, 409, 503))
def delete_scene_object(name: ObjectName, station: StationDep) -> wire.Scene:
    """Remove an object with a role; return the remaining objects."""
    station.surroundings.remove(name)
    return scene(station)


@router.post(
    "/scene/{name}/attach",
    **change(404, 409, 413, 422, 503),
)
def attach_scene_object(
    name: ObjectName, station: StationDep, request: wire.AttachRequest | None = None
) -> wire.SceneObject:
    """Let an arm carry an object, which then moves and is guarded as part of the hand.

    The arm must not move, because its load is set. A simulated body stays a body, so
    the fingers must hold it.
    """
    asked = request or wire.AttachRequest()
    found = station.surroundings.attach(name, asked.arm, load=asked.load)
    return wire.SceneObject.model_validate(found)


@router.post(
    "/scene/{name}/detach",
    **change(404, 409, 413, 422, 503),
)
def detach_scene_object(
    name: ObjectName, station: StationDep, request: wire.DetachRequest | None = None
) -> wire.SceneObject:
    """Let an arm put an object down, at the object's present pose."""
    asked = request or wire.DetachRequest()
    found = station.surroundings.detach(name, load=asked.load)
    return wire.SceneObject.model_validate(found)


@router.get("/scenes", responses=problems())
def list_scenes(services: ServicesDep) -> wire.SavedScenes:
    """List the saved scenes."""
    return wire.SavedScenes(scenes=services.scenes.names())


@router.get("/scenes/{name}", responses=problems(404, 422))
def get_saved_scene(name: SceneName, services: ServicesDep) -> SavedScene:
    """Return a saved scene with its objects."""
    return services.scenes.get(name)


@router.put("/scenes/{name}", **change(404, 422))
def save_scene(
    name: SceneName, services: ServicesDep, station: StationDep
) -> SavedScene:
    """Save the present objects with a role; they replace a scene of the same name.

    Solid and carried objects are left out.
    """
    return services.scenes.save(name, station.surroundings.entries())


@router.post(
    "/scenes/{name}/load",
    **change(404, 409, 422, 503),
)
def load_scene(
    name: SceneName, services: ServicesDep, station: StationDep
) -> wire.Scene:
    """Replace the objects with a role by those of a saved scene."""
    station.surroundings.replace_roles(services.scenes.get(name).objects)
    return scene(station)


@router.delete("/scenes/{name}", **change(404, 422))
def delete_saved_scene(name: SceneName, services: ServicesDep) -> SavedScene:
    """Delete a saved scene; return it."""
    return services.scenes.delete(name)
