"""Wire models of plot layouts, of waypoint paths and of their playing."""

from typing import Annotated, Literal

from pydantic import Field

from station.reports import Playback
from station.wire.base import (
    ControllerName,
    Items,
    RequestModel,
    ResponseModel,
)

_Dock = Annotated[str, Field(pattern=r"^[a-z]{1,40}$")]
_Pixels = Annotated[float, Field(ge=0.0, le=20_000.0, allow_inf_nan=False)]
_Key = Annotated[str, Field(min_length=1, max_length=200)]


class PlotRequest(RequestModel):
    """One plot of a layout.

    Attributes:
        keys: Its channels, as the page names them, 100 at most.
        xy: Whether the other channels are drawn over the first one, not over time.
        span: How much time is shown [s], above 0 and at most 3600.
        transform: Transform of the channels; empty for none.
    """

    keys: list[_Key] = Field(max_length=100)
    xy: bool = False
    span: float = Field(default=10.0, gt=0.0, le=3600.0)
    transform: Literal["", "smooth", "difference", "norm", "spectrum"] = ""


class DocksRequest(RequestModel):
    """Folds and sizes of the docks around the plots.

    Attributes:
        folded: The docks that are folded, as the page names them.
        side: Width of a column of docks beside the 3D view [pixels].
        below: Height of the docks below it [pixels].
        heights: Heights of the docks that a user has resized [pixels].
    """

    folded: list[_Dock] = Field(max_length=32)
    side: _Pixels
    below: _Pixels
    heights: dict[_Dock, _Pixels] = Field(default_factory=dict, max_length=32)


class PlotLayoutRequest(RequestModel):
    """The plots of a layout, from left to right, and perhaps the docks around them.

    Attributes:
        plots: The plots, 32 at most; they replace those of the layout.
        docks: Folds and sizes of the docks; null leaves those of the layout.

    Example:
        {"plots": [{"keys": ["position/panda_joint1"], "span": 30.0}]}
    """

    plots: list[PlotRequest] = Field(max_length=32)
    docks: DocksRequest | None = None


class PlotLayouts(ResponseModel):
    """The saved plot layouts.

    Attributes:
        plot_layouts: Names of the layouts, sorted.
    """

    plot_layouts: Items[str]


_WaypointName = Annotated[str, Field(min_length=1, max_length=100)]
_Duration = Annotated[float, Field(gt=0.0, le=600.0, allow_inf_nan=False)]
_Speed = Annotated[float, Field(ge=0.05, le=2.0, allow_inf_nan=False)]
_Number = Annotated[int, Field(ge=0, lt=500)]


class WaypointRequest(RequestModel):
    """A place that joints pass.

    Attributes:
        name: Name.
        duration: Time to it from the waypoint before, at the speed 1 [s], above 0 and
            at most 600.
        positions: Positions [rad or m] by joint; joints without one keep theirs.
    """

    name: _WaypointName
    duration: _Duration = 2.0
    positions: dict[str, Annotated[float, Field(allow_inf_nan=False)]] = Field(
        min_length=1, max_length=64
    )


class WaypointPathRequest(RequestModel):
    """The waypoints of a path, in the order in which they are passed.

    Attributes:
        waypoints: The waypoints, 500 at most; they replace those of the path.

    Example:
        {"waypoints": [{"name": "up", "duration": 2.0, "positions": {"panda_joint1":
         0.3}}]}
    """

    waypoints: list[WaypointRequest] = Field(max_length=500)


class CaptureRequest(RequestModel):
    """Add the present positions of the joints to a path.

    Attributes:
        name: Name of the waypoint; `point N` when null or left out.
        duration: Time to it from the waypoint before, at the speed 1 [s], above 0 and
            at most 600.

    Example:
        {"name": "up", "duration": 2.0}
    """

    name: _WaypointName | None = None
    duration: _Duration = 2.0


class WaypointPaths(ResponseModel):
    """The saved paths.

    Attributes:
        waypoint_paths: Names of the paths, sorted.
    """

    waypoint_paths: Items[str]


class PlayRequest(RequestModel):
    """Options with which a path is played.

    Attributes:
        controller: The trajectory controller that moves along it; null for the one
            that runs and moves joints of the path.
        speed: Factor of all speeds, 0.05 to 2; without a unit.
        loop: Begin again at the end, until it is switched off or something ends it.
        first: Number of the first waypoint that is gone to, from 0.
        last: Number of the last one; null for the path's last one.

    Example:
        {"speed": 0.5, "loop": true}
    """

    controller: ControllerName | None = None
    speed: _Speed = 1.0
    loop: bool = False
    first: _Number = 0
    last: _Number | None = None


class PlaybackPatch(RequestModel):
    """Change the path that plays; a field that is null or left out keeps its value.

    Attributes:
        paused: True lets the robot hold where it is; false goes on.
        speed: Factor of all speeds, 0.05 to 2; without a unit.
        loop: Whether it begins again at its end.

    Example:
        {"paused": true}
    """

    paused: bool | None = None
    speed: _Speed | None = None
    loop: bool | None = None


class LastPlayback(ResponseModel):
    """Path that plays, or played last.

    Attributes:
        playback: The path that plays or played last; null when none was played yet.
    """

    playback: Playback | None
