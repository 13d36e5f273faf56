"""Set-points, goals and trajectories of controllers, and controllers' states."""

from functools import partial
from typing import Annotated

from fastapi import Query

from station import wire
from station.api import answers
from station.api.dependencies import (
    AccessDep,
    LeaseKey,
    ServicesDep,
    StationDep,
)
from station.api.errors import ProblemError
from station.api.routes.rehearsals import ByRehearsalDep, is_hold
from station.api.routes.routing import ApiRouter, change, problems, routes_of
from station.core.control import controller as core_controller
from station.wire import CommandAccepted, CommandInfo, CommandRequest, ControllerSample

_set_points = routes_of("set-points")


@_set_points.get("/controllers/{name}/command", responses=problems(404, 422))
def get_command(name: str, station: StationDep) -> CommandInfo:
    """Return the elements of a controller's set-point, and the last set-point."""
    return answers.command_info(station.motion.set_point(name))


@_set_points.put(
    "/controllers/{name}/command", **change(404, 409, 412, 413, 422, 423, 428)
)
def put_command(
    name: str,
    request: CommandRequest,
    station: StationDep,
    services: ServicesDep,
    access: AccessDep,
    by_rehearsal: ByRehearsalDep,
    key: LeaseKey = None,
) -> CommandAccepted:
    """Give a running controller a set-point, which replaces an older one.

    The answer has the number of the first cycle with the set-point.
    """
    values, timeout, rates = request.command, request.timeout, request.rates
    command = {"name": name, "values": values, "timeout": timeout, "rates": rates}
    with by_rehearsal.giving("set_point", command) as certified:
        ticket = certified or station.motion.ticket()
        # Check again, because control may have changed hands since the check of the
        # request.
        with services.control.commanding(access, key, name):
            epoch = station.motion.set_command(
                name,
                values,
                request.epoch,
                timeout,
                rates,
                ticket,
            )
    return CommandAccepted(epoch=epoch, cycle=station.motion.wait_for(ticket))


@_set_points.get("/controllers/{name}/state", responses=problems(404, 409))
def get_controller_state(name: str, station: StationDep) -> ControllerSample:
    """Return a controller's values in the last cycle, and its latest messages.

    The values are `desired`, `actual`, `error` and `output`. Sensor controllers have
    only messages.

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


_goals = routes_of("goals")


@_goals.post(
    "/controllers/{name}/goals",
    status_code=201,
    **change(404, 409, 412, 413, 422, 423, 428),
)
def submit_goal(
    name: str,
    request: wire.GoalRequest,
    station: StationDep,
    services: ServicesDep,
    access: AccessDep,
    by_rehearsal: ByRehearsalDep,
    key: LeaseKey = None,
) -> wire.Goal:
    """Give a running controller a goal, which replaces the goal before.

    A stop, a reset, a recovery, or a client that takes control by force ends the goal;
    nothing resumes it.
    """
    admit = partial(services.control.admit, access, key, name)
    with by_rehearsal.giving("goal", {"name": name, "request": request.goal}) as ticket:
        found = station.motion.submit_goal(
            name, request.goal, request.epoch, admit, ticket
        )
    return answers.goal(found)


@_goals.get("/controllers/{name}/goals", responses=problems(404, 422))
def list_goals(name: str, station: StationDep) -> wire.Goals:
    """List the latest goals of a controller, oldest first."""
    return wire.Goals(goals=[answers.goal(goal) for goal in station.motion.goals(name)])


@_goals.get("/controllers/{name}/goals/{goal_id}", responses=problems(404, 422))
def get_goal(name: str, goal_id: str, station: StationDep) -> wire.Goal:
    """Return a goal with its progress, or how and why it ended."""
    return answers.goal(station.motion.goal(name, goal_id))


@_goals.delete("/controllers/{name}/goals/{goal_id}", **change(404, 422))
def cancel_goal(name: str, goal_id: str, station: StationDep) -> wire.Goal:
    """Cancel a goal; the joints hold from the next cycle on.

    A goal that has ended does not change.
    """
    return answers.goal(station.motion.cancel_goal(name, goal_id))


@_goals.post(
    "/controllers/{name}/trajectory", **change(404, 409, 412, 413, 422, 423, 428)
)
def follow_trajectory(
    name: str,
    request: wire.TrajectoryRequest,
    station: StationDep,
    services: ServicesDep,
    access: AccessDep,
    by_rehearsal: ByRehearsalDep,
    key: LeaseKey = None,
) -> wire.CommandAccepted:
    """Let a running controller follow a trajectory without a goal.

    This is like the topic `command` of a joint trajectory controller. Without points
    the joints stop and hold.
    """
    trajectory = request.trajectory
    moves, command = not is_hold(trajectory), {"name": name, "request": trajectory}
    with by_rehearsal.giving("trajectory", command, moves=moves) as certified:
        ticket = certified or station.motion.ticket()
        epoch = station.motion.follow_trajectory(
            name,
            trajectory,
            request.epoch,
            ticket,
            partial(services.control.admit, access, key, name, is_bounded=not moves),
        )
    return wire.CommandAccepted(epoch=epoch, cycle=station.motion.wait_for(ticket))


@_goals.get("/controllers/{name}/query_state", responses=problems(404, 409, 422))
def query_state(
    name: str,
    station: StationDep,
    time: Annotated[
        float | None,
        Query(allow_inf_nan=False),
    ] = None,
) -> wire.DesiredState:
    """Return the desired joint state of a trajectory controller at a time."""
    state = station.motion.query_state(name, time)
    return answers.desired_state(
        state, station.manager.get_controller(name).joint_names
    )


router = ApiRouter()
router.join(_set_points, _goals)
