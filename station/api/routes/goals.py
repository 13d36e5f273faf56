"""Goals of controllers, and trajectories without a goal."""

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Query

from station.api import answers
from station.api.by_rehearsal import ByRehearsalDep
from station.api.dependencies import (
    AccessDep,
    LeaseKey,
    ServicesDep,
    StationDep,
    Viewer,
)
from station.api.json_route import JsonRoute
from station.api.routes.problems import change, problems
from station.wire import (
    CommandAccepted,
    DesiredState,
    Goal,
    GoalRequest,
    Goals,
    TrajectoryRequest,
)

router = APIRouter(tags=["goals"], dependencies=[Viewer], route_class=JsonRoute)


@router.post(
    "/controllers/{name}/goals",
    status_code=201,
    **change(404, 409, 412, 413, 422, 423, 428),
)
def submit_goal(
    name: str,
    request: GoalRequest,
    station: StationDep,
    services: ServicesDep,
    access: AccessDep,
    by_rehearsal: ByRehearsalDep,
    key: LeaseKey = None,
) -> Goal:
    """Give a running controller a goal; it replaces the one before.

    A stop, a reset or a recovery ends the goal, and so does whoever takes control by
    force; nothing resumes it.
    """
    admit = partial(services.control.admit, access, key, name)
    with by_rehearsal.giving("goal", name=name, request=request.goal) as receipt:
        found = station.motion.submit_goal(
            name, request.goal, request.epoch, admit, receipt
        )
    return answers.goal(found)


@router.get("/controllers/{name}/goals", responses=problems(404, 422))
def list_goals(name: str, station: StationDep) -> Goals:
    """List the latest goals of a controller, oldest first."""
    return Goals(goals=[answers.goal(goal) for goal in station.motion.goals(name)])


@router.get("/controllers/{name}/goals/{goal_id}", responses=problems(404, 422))
def get_goal(name: str, goal_id: str, station: StationDep) -> Goal:
    """Return one goal: its progress, or how and why it ended."""
    return answers.goal(station.motion.goal(name, goal_id))


@router.delete("/controllers/{name}/goals/{goal_id}", **change(404, 422))
def cancel_goal(name: str, goal_id: str, station: StationDep) -> Goal:
    """Cancel a goal; the joints hold from the next cycle on.

    A goal that has ended does not change.
    """
    return answers.goal(station.motion.cancel_goal(name, goal_id))


@router.post(
    "/controllers/{name}/trajectory", **change(404, 409, 412, 413, 422, 423, 428)
)
def follow_trajectory(
    name: str,
    request: TrajectoryRequest,
    station: StationDep,
    services: ServicesDep,
    access: AccessDep,
    by_rehearsal: ByRehearsalDep,
    key: LeaseKey = None,
) -> CommandAccepted:
    """Let a running controller follow a trajectory without a goal.

    This is the topic `command` of a joint trajectory controller. Without points the
    joints stop and hold.
    """
    trajectory = request.trajectory
    with by_rehearsal.giving("trajectory", name=name, request=trajectory) as certified:
        receipt = certified or station.motion.receipt()
        epoch = station.motion.follow_trajectory(
            name,
            trajectory,
            request.epoch,
            receipt,
            partial(services.control.admit, access, key, name),
        )
    return CommandAccepted(epoch=epoch, cycle=station.motion.wait_for(receipt))


@router.get("/controllers/{name}/query_state", responses=problems(404, 409, 422))
def query_state(
    name: str,
    station: StationDep,
    time: Annotated[
        float | None,
        Query(allow_inf_nan=False),
    ] = None,
) -> DesiredState:
    """Return the desired joint state of a trajectory controller at a time."""
    state = station.motion.query_state(name, time)
    return answers.desired_state(
        state, station.manager.get_controller(name).joint_names
    )
