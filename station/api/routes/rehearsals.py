"""Rehearsals: what a command would do, tried in a copy of the station."""

from fastapi import APIRouter

from station.api.dependencies import OperatorAnyway, ServicesDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.reports import Rehearsal
from station.wire.rehearsal import RehearsalRequest

router = APIRouter(tags=["rehearsals"], dependencies=[Viewer], route_class=JsonRoute)


@router.post(
    "/rehearse",
    dependencies=[OperatorAnyway],
    responses=problems(413, 422, 503),
)
def rehearse(request: RehearsalRequest, services: ServicesDep) -> Rehearsal:
    """Tell how commands would end, and in which cycle, without moving anything.

    A copy of the simulated station carries them out ahead of time: the same world, the
    same controllers in the same state. A stepped station then goes the same way bit for
    bit. With a certificate a command is carried out only if nothing that matters has
    changed since, and the station stops if the robot leaves the rehearsed motion.
    """
    steps = [step.as_input() for step in request.steps]
    return services.rehearsals.rehearse(
        steps, request.seconds, certify=request.certificate
    )
