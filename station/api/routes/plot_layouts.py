"""Plot layouts: which plots a page shows, kept at the station under a name."""

from typing import Annotated

from fastapi import APIRouter, Path

from station.api.dependencies import Operator, ServicesDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.reports import DockSettings, PlotLayout, PlotSettings
from station.wire import PlotLayoutRequest, PlotLayouts
from station.wire.base import FileName

router = APIRouter(tags=["plot-layouts"], dependencies=[Viewer], route_class=JsonRoute)
Name = Annotated[
    FileName, Path(description="Name of the layout.", examples=["torques"])
]


@router.get("/plot-layouts", responses=problems())
def list_plot_layouts(services: ServicesDep) -> PlotLayouts:
    """List the saved plot layouts."""
    return PlotLayouts(plot_layouts=services.plot_layouts.names())


@router.get("/plot-layouts/{name}", responses=problems(404, 422))
def get_plot_layout(name: Name, services: ServicesDep) -> PlotLayout:
    """Return a layout with its plots."""
    return services.plot_layouts.get(name)


@router.put(
    "/plot-layouts/{name}", dependencies=[Operator], responses=problems(404, 413, 422)
)
def save_plot_layout(
    name: Name, request: PlotLayoutRequest, services: ServicesDep
) -> PlotLayout:
    """Save the plots of a layout, and its docks; a layout of that name is replaced."""
    plots = [PlotSettings(**plot.model_dump()) for plot in request.plots]
    asked = request.docks
    docks = None if asked is None else DockSettings(**asked.model_dump())
    return services.plot_layouts.save(name, plots, docks)


@router.delete(
    "/plot-layouts/{name}", dependencies=[Operator], responses=problems(404, 422)
)
def delete_plot_layout(name: Name, services: ServicesDep) -> PlotLayout:
    """Delete a layout; return its last content."""
    return services.plot_layouts.delete(name)
