"""Controllers: list, load, unload, switch."""

import logging

from fastapi import APIRouter, Request, Response

from station.api import answers
from station.api.audit import note_preview
from station.api.by_rehearsal import ByRehearsalDep
from station.api.dependencies import Operator, ServicesDep, StationDep, Viewer
from station.api.idempotency import Idempotent, IdempotentRoute
from station.api.routes.problems import change, problems
from station.core.control import switching
from station.core.facade.station import Station
from station.wire import (
    ControllerChains,
    Controllers,
    ControllerState,
    ControllerType,
    ControllerTypes,
    LoadRequest,
    Reloaded,
    ReloadRequest,
    SwitchRequest,
    SwitchResult,
)

_LOGGER = logging.getLogger(__name__)
router = APIRouter(
    tags=["controllers"], dependencies=[Viewer], route_class=IdempotentRoute
)


@router.get("/controllers", responses=problems())
def list_controllers(station: StationDep) -> Controllers:
    """List the loaded controllers, in the order in which they are updated."""
    return answers.controllers(station)


@router.post(
    "/controllers",
    status_code=201,
    dependencies=[Operator, Idempotent],
    responses={
        200: {"model": ControllerState, "description": "It is loaded already."},
        **problems(404, 409, 413, 422),
    },
)
def load_controller(
    request: LoadRequest, response: Response, station: StationDep
) -> ControllerState:
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
    return ControllerState.model_validate(status)


def _is_loaded(station: Station, name: str) -> bool:
    return any(status.name == name for status in station.controllers())


@router.post(
    "/controllers/switch",
    dependencies=[Operator, Idempotent],
    responses=problems(404, 409, 413, 422, 423, 503, 504),
)
def switch_controllers(
    request: SwitchRequest,
    connection: Request,
    station: StationDep,
    services: ServicesDep,
    by_rehearsal: ByRehearsalDep,
) -> SwitchResult:
    """Start and stop controllers, all of them in one cycle.

    The answer says what was started and stopped, and by how much the command of each
    joint jumped. A conflict answers 409 and names the controllers that hold the joints.
    """
    if request.dry_run:
        note_preview(connection)
    if request.strictness == "strict":
        for name in (*request.start, *request.stop):
            station.controller(name)  # an unknown name is a 404, not a conflict
    with by_rehearsal.giving("switch", start=request.start, stop=request.stop):
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


@router.get("/controllers/chains", responses=problems())
def list_chains(station: StationDep) -> ControllerChains:
    """Return the loaded controllers with who commands whose references."""
    return station.manager.chains()


@router.get("/controllers/{name}", responses=problems(404))
def get_controller(name: str, station: StationDep) -> ControllerState:
    """Return one controller."""
    return ControllerState.model_validate(station.controller(name))


@router.delete(
    "/controllers/{name}",
    dependencies=[Operator, Idempotent],
    responses=problems(404, 409, 422),
)
def unload_controller(name: str, station: StationDep) -> ControllerState:
    """Unload a controller that does not run; return its last state.

    The loading of a controller that is still `loading` is cancelled, and the request
    that loads the controller is refused.
    """
    before = ControllerState.model_validate(station.controller(name))
    station.unload_controller(name)
    return before


@router.get("/controller-types", responses=problems())
def list_controller_types(station: StationDep) -> ControllerTypes:
    """List the types of controllers that can be loaded, each with its parameters."""
    return ControllerTypes(
        controller_types=[
            ControllerType.model_validate(each)
            for each in station.manager.describe_controller_types()
        ]
    )


@router.post("/controller-types/reload", **change(409, 413, 422, 504))
def reload_controller_types(
    station: StationDep, request: ReloadRequest | None = None
) -> Reloaded:
    """Let the next load of each type read its Python module anew.

    This is the service `reload_controller_libraries` of ros_control: controllers that
    are loaded are a reason to refuse, unless `force_kill` stops and unloads them.
    """
    force_kill = request is not None and request.force_kill
    unloaded = station.manager.reload_controller_libraries(force_kill=force_kill)
    return Reloaded(unloaded=unloaded)
