"""The tree of parameters that controllers are loaded with."""

from fastapi import APIRouter

from station.api.dependencies import StationDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import change, problems
from station.wire import Parameter, ParameterRequest

router = APIRouter(
    prefix="/parameters",
    tags=["parameters"],
    dependencies=[Viewer],
    route_class=JsonRoute,
)


@router.get("", responses=problems())
def get_parameters(station: StationDep) -> Parameter:
    """Return the whole tree of parameters."""
    return _parameter("", station.parameter_server.get())


@router.get("/{path:path}", responses=problems(404))
def get_parameter(path: str, station: StationDep) -> Parameter:
    """Return a parameter, or a namespace with all that is below it."""
    return _parameter(path, station.parameter_server.get(path))


@router.put("/{path:path}", **change(409, 413, 422))
def set_parameter(
    path: str, request: ParameterRequest, station: StationDep
) -> Parameter:
    """Set a parameter; controllers that are loaded afterwards read it.

    Missing namespaces are made. A controller that is loaded already keeps what it has
    read; its gains are changed by PATCH of its gains.
    """
    station.parameter_server.set(path, request.value)
    return _parameter(path, request.value)


@router.delete("/{path:path}", **change(404, 409, 422))
def delete_parameter(path: str, station: StationDep) -> Parameter:
    """Delete a parameter or a namespace; return its last value."""
    return _parameter(path, station.parameter_server.delete(path))


def _parameter(path: str, value: object) -> Parameter:
    return Parameter.model_validate({"path": path.strip("/"), "value": value})
