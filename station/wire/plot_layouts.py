"""Wire models of plot layouts."""

from typing import Annotated, Literal

from pydantic import Field

from station.wire.base import Items, RequestModel, ResponseModel

_Dock = Annotated[str, Field(pattern=r"^[a-z]{1,40}$")]
_Pixels = Annotated[float, Field(ge=0.0, le=20_000.0, allow_inf_nan=False)]
_Key = Annotated[str, Field(min_length=1, max_length=200)]


class PlotRequest(RequestModel):
    """One plot of a layout.

    Attributes:
        keys: Its channels, as the page names them, 100 at most.
        xy: Whether the others are drawn over the first channel, not over time.
        span: How much time is shown [s], above 0 and at most 3600.
        transform: What is shown of the channels; empty for the channels as they are.
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
        heights: Heights of docks that somebody has resized [pixels].
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
