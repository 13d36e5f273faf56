"""Plot layouts and waypoint paths, saved by name, and the playing of paths."""

from typing import Annotated

from fastapi import Path

from station import wire
from station.api.dependencies import ServicesDep
from station.api.routes.rehearsals import ByRehearsalDep
from station.api.routes.routing import ApiRouter, change, problems, routes_of
from station.library.path_player import PlayOptions
from station.reports import (
    DockSettings,
    Playback,
    PlotLayout,
    PlotSettings,
    Waypoint,
    WaypointPath,
)
from station.wire import PlotLayoutRequest, PlotLayouts
from station.wire.base import FileName

_layouts = routes_of("plot-layouts")
LayoutName = Annotated[
    FileName, Path(description="Name of the layout.", examples=["torques"])
]


@_layouts.get("/plot-layouts", responses=problems())
def list_plot_layouts(services: ServicesDep) -> PlotLayouts:
    """List the saved plot layouts."""
    return PlotLayouts(plot_layouts=services.plot_layouts.names())


@_layouts.get("/plot-layouts/{name}", responses=problems(404, 422))
def get_plot_layout(name: LayoutName, services: ServicesDep) -> PlotLayout:
    """Return a layout with its plots."""
    return services.plot_layouts.get(name)


@_layouts.put("/plot-layouts/{name}", **change(404, 413, 422))
def save_plot_layout(
    name: LayoutName, request: PlotLayoutRequest, services: ServicesDep
) -> PlotLayout:
    """Save the plots and docks of a layout; they replace those of the same name."""
    plots = [PlotSettings(**plot.model_dump()) for plot in request.plots]
    asked = request.docks
    docks = None if asked is None else DockSettings(**asked.model_dump())
    return services.plot_layouts.save(name, plots, docks)


@_layouts.delete("/plot-layouts/{name}", **change(404, 422))
def delete_plot_layout(name: LayoutName, services: ServicesDep) -> PlotLayout:
    """Delete a layout; return it."""
    return services.plot_layouts.delete(name)


_paths = routes_of("waypoint-paths")
PathName = Annotated[FileName, Path(description="Name of the path.", examples=["wave"])]


@_paths.get("/waypoint-paths", responses=problems())
def list_waypoint_paths(services: ServicesDep) -> wire.WaypointPaths:
    """List the saved waypoint paths."""
    return wire.WaypointPaths(waypoint_paths=services.waypoint_paths.names())


@_paths.get("/waypoint-paths/{name}", responses=problems(404, 422))
def get_waypoint_path(name: PathName, services: ServicesDep) -> WaypointPath:
    """Return a path with its waypoints."""
    return services.waypoint_paths.get(name)


@_paths.put("/waypoint-paths/{name}", **change(404, 413, 422))
def save_waypoint_path(
    name: PathName, request: wire.WaypointPathRequest, services: ServicesDep
) -> WaypointPath:
    """Save the waypoints of a path; they replace a path of the same name."""
    found = [
        Waypoint(each.name, each.duration, each.positions) for each in request.waypoints
    ]
    return services.waypoint_paths.save(name, found)


@_paths.delete("/waypoint-paths/{name}", **change(404, 422))
def delete_waypoint_path(name: PathName, services: ServicesDep) -> WaypointPath:
    """Delete a path; return it."""
    return services.waypoint_paths.delete(name)


@_paths.post("/waypoint-paths/{name}/capture", **change(404, 413, 422, 503))
def capture_waypoint(
    name: PathName, services: ServicesDep, request: wire.CaptureRequest | None = None
) -> WaypointPath:
    """Add the present positions to the end of a path, which may be new.

    This captures the joints that loaded trajectory controllers move, or all joints
    without such a controller.
    """
    wanted = request or wire.CaptureRequest()
    return services.waypoint_paths.capture(name, wanted.name or "", wanted.duration)


@_paths.post(
    "/waypoint-paths/{name}/play", **change(404, 409, 412, 413, 422, 423, 428, 503)
)
def play_waypoint_path(
    name: PathName,
    services: ServicesDep,
    by_rehearsal: ByRehearsalDep,
    request: wire.PlayRequest | None = None,
) -> Playback:
    """Move along a path; it replaces a path that plays now.

    The robot follows goals of a running trajectory controller, one per round. A stop,
    another goal, a switch or a violated tolerance ends the path; nothing resumes it.
    Joints that go on in the same direction do not stop at a waypoint.
    """
    wanted = request or wire.PlayRequest()
    options = wanted.model_dump()
    with by_rehearsal.giving("path", {"path": name, "options": options}) as ticket:
        return services.path_player.play(name, PlayOptions(**options), ticket)


@_paths.get("/playback", responses=problems())
def get_playback(services: ServicesDep) -> wire.LastPlayback:
    """Return the path that plays, or how the last one ended."""
    found = services.path_player.state()
    return wire.LastPlayback.model_validate({"playback": found})


@_paths.patch("/playback", **change(404, 409, 413, 422, 423, 428, 503))
def change_playback(request: wire.PlaybackPatch, services: ServicesDep) -> Playback:
    """Pause or resume the path that plays, or change its speed or loop.

    Where motions have to be rehearsed, a path can only be paused.
    """
    player = services.path_player
    if request.paused is False or request.speed is not None or request.loop:
        services.rehearsals.check(is_agent=False)  # agents may not call this
    found = player.adjust(speed=request.speed, loop=request.loop)
    if request.paused is not None:
        found = player.pause() if request.paused else player.resume()
    return found


@_paths.delete("/playback", **change(404, 409))
def cancel_playback(services: ServicesDep) -> Playback:
    """End the path that plays; the robot holds where it is."""
    return services.path_player.cancel()


router = ApiRouter()
router.join(_layouts, _paths)
