"""Rehearsals: what a command would do, tried in a copy of the station."""

from fastapi import APIRouter

from station.api.auth import Role
from station.api.dependencies import AccessDep, ServicesDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import change
from station.rehearsal.planning import Wish
from station.reports import Plan, Rehearsal
from station.wire.rehearsal import PlanRequest, RehearsalRequest

router = APIRouter(tags=["rehearsals"], dependencies=[Viewer], route_class=JsonRoute)


@router.post("/rehearse", **change(413, 422, 429, 503))
def rehearse(
    request: RehearsalRequest, services: ServicesDep, access: AccessDep
) -> Rehearsal:
    """Forecast the end of commands without moving anything.

    A copy of the simulated station carries them out ahead of time: the same world, the
    same controllers in the same state. A stepped station then goes the same way bit for
    bit. With a certificate a command is carried out only if nothing that matters has
    changed since, and the station stops if the robot leaves the rehearsed motion.
    """
    steps = [step.as_input() for step in request.steps]
    return services.rehearsals.rehearse(
        steps,
        request.seconds,
        certify=request.certificate,
        is_agent=access.role is Role.AGENT,
        who=access.name,
    )


@router.post("/plan", **change(404, 409, 413, 422, 429, 503))
def plan(request: PlanRequest, services: ServicesDep, access: AccessDep) -> Plan:
    """Return a goal that leads to a pose and touches nothing; nothing moves.

    The path keeps 5 mm from everything, is timed within the limits, and was rehearsed.
    Without a path the answer says why: which bodies would touch in the pose, which
    joint would leave its range, or that the time was over.
    """
    wish = Wish(request.controller, request.positions, request.timeout, request.seed)
    return services.rehearsals.plan(wish, access.name)
