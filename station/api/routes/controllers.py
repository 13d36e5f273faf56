"""Controllers: list, load, unload and switch them, and set their parameters."""

import logging

from fastapi import Request, Response
from fastapi.responses import PlainTextResponse

from station import wire
from station.api import answers
from station.api.audit import note_preview
from station.api.dependencies import Operator, ServicesDep, StationDep
from station.api.idempotency import Idempotent, IdempotentRoute
from station.api.routes.rehearsals import ByRehearsalDep
from station.api.routes.routing import ApiRouter, change, problems, routes_of
from station.core.control import switching
from station.core.facade.station import Station
from station.library.gain_sets import controller_file
from station.wire import Parameter, ParameterRequest

_LOGGER = logging.getLogger(__name__)
_controllers = routes_of("controllers", kind=IdempotentRoute)


@_controllers.get("/controllers", responses=problems())
def list_controllers(station: StationDep) -> wire.Controllers:
    """List the loaded controllers, in the order in which they are updated."""
    return answers.controllers(station)


@_controllers.post(
    "/controllers",
    status_code=201,
    dependencies=[Operator, Idempotent],
    responses={
        200: {"model": wire.ControllerState, "description": "It is loaded already."},
        **problems(404, 409, 413, 422),
    },
)
def load_controller(
    request: wire.LoadRequest, response: Response, station: StationDep
) -> wire.ControllerState:
    """Load a controller; loading the same one again changes nothing and answers 200."""
    if _is_loaded(station, request.name):
        response.status_code = 200
    status = station.load_controller(
        request.name,
        request.type,
        request.params,
        timeout=request.timeout,
        strict=request.params is not None and request.unknown_params == "refuse",
    )
    for note in status.notes:
        _LOGGER.warning("Controller '%s': %s", status.name, note)
    return wire.ControllerState.model_validate(status)


def _is_loaded(station: Station, name: str) -> bool:
    return any(status.name == name for status in station.controllers())


@_controllers.post(
    "/controllers/switch",
    dependencies=[Operator, Idempotent],
    responses=problems(404, 409, 413, 422, 423, 503, 504),
)
def switch_controllers(
    request: wire.SwitchRequest,
    connection: Request,
    station: StationDep,
    services: ServicesDep,
    by_rehearsal: ByRehearsalDep,
) -> wire.SwitchResult:
    """Start and stop controllers, all of them in one cycle.

    The answer lists the started and stopped controllers, and the step of each joint's
    command. A conflict gives 409, and names the controllers that claim the joints.
    """
    if request.dry_run:
        note_preview(connection)
    if request.strictness == "strict":
        for name in (*request.start, *request.stop):
            station.controller(name)  # an unknown name gives 404, not a conflict
    command = {"start": request.start, "stop": request.stop}
    with by_rehearsal.giving("switch", command, moves=False):
        result = station.switch_controllers(
            switching.SwitchRequest(
                start=tuple(request.start),
                stop=tuple(request.stop),
                strictness=switching.Strictness[request.strictness.upper()],
                start_asap=request.start_asap,
                timeout=request.timeout,
                bound=request.bound,
                dry_run=request.dry_run,
            )
        )
    if not request.dry_run:
        services.event_recorder.switch(connection, result)
    return answers.switch_result(result)


@_controllers.get("/controllers/chains", responses=problems())
def list_chains(station: StationDep) -> wire.ControllerChains:
    """Return the loaded controllers, with the references that each commands."""
    return station.manager.chains()


@_controllers.get("/controllers/{name}", responses=problems(404))
def get_controller(name: str, station: StationDep) -> wire.ControllerState:
    """Return one controller."""
    return wire.ControllerState.model_validate(station.controller(name))


@_controllers.get(
    "/controllers/{name}/config.yaml",
    response_class=PlainTextResponse,
    responses=problems(404),
)
def get_controller_config(name: str, station: StationDep) -> PlainTextResponse:
    """Return the parameters of a controller, with its gains in force, as a file.

    It is a parameter file of ros_control in YAML, which `station run --controllers`
    loads.
    """
    return PlainTextResponse(controller_file(station, name))


@_controllers.delete(
    "/controllers/{name}",
    dependencies=[Operator, Idempotent],
    responses=problems(404, 409, 422),
)
def unload_controller(name: str, station: StationDep) -> wire.ControllerState:
    """Unload a stopped controller; return its last state.

    For a controller that is still `loading`, this cancels the loading, and refuses the
    request that loads it.
    """
    before = wire.ControllerState.model_validate(station.controller(name))
    station.unload_controller(name)
    return before


@_controllers.get("/controller-types", responses=problems())
def list_controller_types(station: StationDep) -> wire.ControllerTypes:
    """List the types of controllers that can be loaded, each with its parameters."""
    return wire.ControllerTypes(
        controller_types=[
            wire.ControllerType.model_validate(each)
            for each in station.manager.describe_controller_types()
        ]
    )


@_controllers.post("/controller-types/reload", **change(409, 413, 422, 504))
def reload_controller_types(
    station: StationDep, request: wire.ReloadRequest | None = None
) -> wire.Reloaded:
    """Let the next load of each type import its Python module again.

    This is like the service `reload_controller_libraries` of ros_control: it is refused
    while controllers are loaded, unless `force_kill` stops and unloads them.
    """
    force_kill = request is not None and request.force_kill
    unloaded = station.manager.reload_controller_libraries(force_kill=force_kill)
    return wire.Reloaded(unloaded=unloaded)


_parameters = routes_of("parameters", "/parameters")


@_parameters.get("", responses=problems())
def get_parameters(station: StationDep) -> Parameter:
    """Return the whole tree of parameters."""
    return _parameter("", station.parameter_server.get())


@_parameters.get("/{path:path}", responses=problems(404))
def get_parameter(path: str, station: StationDep) -> Parameter:
    """Return a parameter, or a namespace with everything in it."""
    return _parameter(path, station.parameter_server.get(path))


@_parameters.put("/{path:path}", **change(409, 413, 422))
def set_parameter(
    path: str, request: ParameterRequest, station: StationDep
) -> Parameter:
    """Set a parameter, which controllers that are loaded afterwards read.

    Missing namespaces are created. A loaded controller keeps the values that it has
    read; PATCH of its gains changes its gains.
    """
    station.parameter_server.set(path, request.value)
    return _parameter(path, request.value)


@_parameters.delete("/{path:path}", **change(404, 409, 422))
def delete_parameter(path: str, station: StationDep) -> Parameter:
    """Delete a parameter or a namespace; return its last value."""
    return _parameter(path, station.parameter_server.delete(path))


def _parameter(path: str, value: object) -> Parameter:
    return Parameter.model_validate({"path": path.strip("/"), "value": value})


router = ApiRouter()
router.join(_controllers, _parameters)
