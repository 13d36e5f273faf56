"""Waypoint paths: captured, edited, kept, and played."""

from typing import Annotated

from fastapi import APIRouter, Path

from station.api.by_rehearsal import ByRehearsalDep
from station.api.dependencies import ServicesDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import change, problems
from station.library.path_player import PlayOptions
from station.reports import Playback, Waypoint, WaypointPath
from station.wire import (
    CaptureRequest,
    LastPlayback,
    PlaybackPatch,
    PlayRequest,
    WaypointPathRequest,
    WaypointPaths,
)
from station.wire.base import FileName

router = APIRouter(
    tags=["waypoint-paths"], dependencies=[Viewer], route_class=JsonRoute
)
Name = Annotated[FileName, Path(description="Name of the path.", examples=["wave"])]


@router.get("/waypoint-paths", responses=problems())
def list_waypoint_paths(services: ServicesDep) -> WaypointPaths:
    """List the saved waypoint paths."""
    return WaypointPaths(waypoint_paths=services.waypoint_paths.names())


@router.get("/waypoint-paths/{name}", responses=problems(404, 422))
def get_waypoint_path(name: Name, services: ServicesDep) -> WaypointPath:
    """Return a path with its waypoints."""
    return services.waypoint_paths.get(name)


@router.put("/waypoint-paths/{name}", **change(404, 413, 422))
def save_waypoint_path(
    name: Name, request: WaypointPathRequest, services: ServicesDep
) -> WaypointPath:
    """Save the waypoints of a path; a path of that name is replaced."""
    found = [
        Waypoint(each.name, each.duration, each.positions) for each in request.waypoints
    ]
    return services.waypoint_paths.save(name, found)


@router.delete("/waypoint-paths/{name}", **change(404, 422))
def delete_waypoint_path(name: Name, services: ServicesDep) -> WaypointPath:
    """Delete a path; return its last content."""
    return services.waypoint_paths.delete(name)


@router.post("/waypoint-paths/{name}/capture", **change(404, 413, 422, 503))
def capture_waypoint(
    name: Name, services: ServicesDep, request: CaptureRequest | None = None
) -> WaypointPath:
    """Add where the joints are now to the end of a path; the first one makes it.

    Captured are the joints that loaded trajectory controllers move; without such a
    controller, all joints.
    """
    wanted = request or CaptureRequest()
    return services.waypoint_paths.capture(name, wanted.name or "", wanted.duration)


@router.post(
    "/waypoint-paths/{name}/play", **change(404, 409, 412, 413, 422, 423, 428, 503)
)
def play_waypoint_path(
    name: Name,
    services: ServicesDep,
    by_rehearsal: ByRehearsalDep,
    request: PlayRequest | None = None,
) -> Playback:
    """Move along a path; a path that plays is replaced.

    The robot follows goals of a trajectory controller that runs, one a round. A stop,
    another goal, a switch or a violated tolerance ends the path; nothing resumes it.
    Joints that go on in the same direction do not stand still at a waypoint.
    """
    wanted = request or PlayRequest()
    options = wanted.model_dump()
    with by_rehearsal.giving("path", path=name, options=options) as receipt:
        return services.path_player.play(name, PlayOptions(**options), receipt)


@router.get("/playback", responses=problems())
def get_playback(services: ServicesDep) -> LastPlayback:
    """Return the path that plays, or how the last one ended."""
    found = services.path_player.state()
    return LastPlayback.model_validate({"playback": found})


@router.patch("/playback", **change(404, 409, 413, 422, 423, 503))
def change_playback(request: PlaybackPatch, services: ServicesDep) -> Playback:
    """Pause or resume the path that plays; change its speed, or whether it loops."""
    player = services.path_player
    found = player.adjust(speed=request.speed, loop=request.loop)
    if request.paused is not None:
        found = player.pause() if request.paused else player.resume()
    return found


@router.delete("/playback", **change(404, 409))
def cancel_playback(services: ServicesDep) -> Playback:
    """End the path that plays; the robot holds where it is."""
    return services.path_player.cancel()
