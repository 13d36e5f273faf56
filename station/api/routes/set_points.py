"""Set-points of controllers, and the states that follow."""

from fastapi import APIRouter

from station.api import answers
from station.api.by_rehearsal import ByRehearsalDep
from station.api.dependencies import (
    AccessDep,
    LeaseKey,
    ServicesDep,
    StationDep,
    Viewer,
)
from station.api.errors import ProblemError
from station.api.json_route import JsonRoute
from station.api.routes.problems import change, problems
from station.core.control import controller as core_controller
from station.wire import CommandAccepted, CommandInfo, CommandRequest, ControllerSample

router = APIRouter(tags=["set-points"], dependencies=[Viewer], route_class=JsonRoute)


@router.get("/controllers/{name}/command", responses=problems(404, 422))
def get_command(name: str, station: StationDep) -> CommandInfo:
    """Return the elements of a controller's set-point, and the last set-point."""
    return answers.command_info(station.motion.set_point(name))


@router.put("/controllers/{name}/command", **change(404, 409, 412, 413, 422, 423, 428))
def put_command(
    name: str,
    request: CommandRequest,
    station: StationDep,
    services: ServicesDep,
    access: AccessDep,
    by_rehearsal: ByRehearsalDep,
    key: LeaseKey = None,
) -> CommandAccepted:
    """Give a running controller a set-point; the newest wins.

    The answer says which cycle was the first with the set-point.
    """
    values, timeout, rates = request.command, request.timeout, request.rates
    command = {"name": name, "values": values, "timeout": timeout, "rates": rates}
    with by_rehearsal.giving("set_point", **command) as certified:
        receipt = certified or station.motion.receipt()
        # Control may have changed hands since the request's access was checked.
        with services.control.commanding(access, key, name):
            epoch = station.motion.set_command(
                name,
                values,
                request.epoch,
                timeout,
                rates,
                receipt,
            )
    return CommandAccepted(epoch=epoch, cycle=station.motion.wait_for(receipt))


@router.get("/controllers/{name}/state", responses=problems(404, 409))
def get_controller_state(name: str, station: StationDep) -> ControllerSample:
    """Return desired, actual, error and output of the last cycle, and messages.

    Sensor controllers have messages alone.

    Raises:
        ProblemError: The controller has not run yet.
    """
    sample, published = station.controller_sample(name), station.published(name)
    if sample is None and not published:
        raise ProblemError(
            409,
            "no_sample",
            f"Controller '{name}' has no state: it has not run, or it reports none.",
            "Start it with POST /api/v1/controllers/switch.",
        )
    names = list(station.manager.get_controller(name).joint_names)
    if sample is None:
        sample = core_controller.ControllerSample(station.loop.time, [], [], [], [])
        names = []
    return answers.controller_sample(sample, names, published)
