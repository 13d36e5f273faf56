"""Alarms: conditions that ask for a person, and their acknowledgement."""

from typing import Annotated

from fastapi import APIRouter, Path, Request

from station.api import answers
from station.api.audit import origin_of
from station.api.dependencies import Operator, ServicesDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.wire import Alarm, Alarms

router = APIRouter(
    prefix="/alarms", tags=["events"], dependencies=[Viewer], route_class=JsonRoute
)
Number = Annotated[
    int, Path(ge=1, le=2**53, description="Number of the alarm.", examples=[3])
]


@router.get("", responses=problems())
def list_alarms(services: ServicesDep) -> Alarms:
    """List the alarms, newest first.

    An alarm leaves the list once its cause is gone and somebody has acknowledged it, in
    either order.
    """
    found = [answers.alarm(each) for each in services.alarms.all()]
    unseen = sum(each.acknowledged_at is None for each in found)
    return Alarms(alarms=found, unacknowledged=unseen)


@router.post(
    "/{number}/acknowledge", dependencies=[Operator], responses=problems(404, 422)
)
def acknowledge_alarm(number: Number, request: Request, services: ServicesDep) -> Alarm:
    """Say that the alarm was seen, under the name of the caller's token.

    It clears no cause and moves nothing. A second acknowledgement changes nothing.
    """
    services.alarms.look()
    return answers.alarm(services.alarms.acknowledge(number, origin_of(request)))
