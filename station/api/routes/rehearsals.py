"""Rehearsals: what a command would do, tried in a copy of the station."""

from fastapi import APIRouter

from station.api.auth import Role
from station.api.dependencies import Operator, RoleDep, ServicesDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.rehearsal.planning import Wish
from station.reports import Plan, Rehearsal
from station.wire.rehearsal import PlanRequest, RehearsalRequest

router = APIRouter(tags=["rehearsals"], dependencies=[Viewer], route_class=JsonRoute)


@router.post(
    "/rehearse",
    dependencies=[Operator],
    responses=problems(413, 422, 503),
)
def rehearse(
    request: RehearsalRequest, services: ServicesDep, role: RoleDep
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
        is_agent=role is Role.AGENT,
    )


@router.post(
    "/plan",
    dependencies=[Operator],
    responses=problems(404, 409, 413, 422, 503),
)
def plan(request: PlanRequest, services: ServicesDep) -> Plan:
    """Return a goal that leads to a target and touches nothing; nothing moves.

    The target is a pose of joints, of the end effector, or one that has a name. The
    path keeps 5 mm from everything, is timed within the limits, and was rehearsed.
    Without a path the answer says why: which bodies would touch in the pose, which
    joint would leave its range or is at its end, or that the time was over.
    """
    rehearsals, positions, place = services.rehearsals, request.positions, request.pose
    if request.name is not None:
        positions = rehearsals.named_pose(request.controller, request.name)
    wish = Wish(
        request.controller,
        positions or {},
        None if place is None else (place.position, place.orientation),
        request.timeout,
        request.seed,
    )
    return rehearsals.plan(wish)
