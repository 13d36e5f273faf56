"""Routes of control: the lease of an operator, and requests of agents."""

import time

from fastapi import Request

from station.api.audit import origin_of
from station.api.auth import Access
from station.api.control import Control
from station.api.dependencies import (
    AccessDep,
    LeaseKey,
    OperatorAnyway,
    ServicesDep,
)
from station.api.routes.routing import problems, routes_of
from station.reports import AgentRequest, Verdict
from station.wire import (
    AgentAnswer,
    AgentRequests,
    ControlPatch,
    ControlRequest,
    ControlState,
)

router = routes_of("control")


@router.get("/control", responses=problems())
def get_control(
    access: AccessDep, services: ServicesDep, key: LeaseKey = None
) -> ControlState:
    """Return the holder of control."""
    return control_state(services.control, access, key)


@router.post(
    "/control", dependencies=[OperatorAnyway], responses=problems(413, 422, 423)
)
def take_control(
    connection: Request,
    access: AccessDep,
    services: ServicesDep,
    request: ControlRequest | None = None,
    key: LeaseKey = None,
) -> ControlState:
    """Take control; a call by the owner is a heartbeat.

    While a client holds control, changes by other operators are refused (423) with the
    owner's name. The stop is never refused. The answer has the `lease`, which the
    owner's requests carry in the header `X-Control-Lease`. Requests with the owner's
    named token or browser session need no lease.
    """
    asked = request or ControlRequest()
    lease = services.control.take(
        access,
        key,
        asked.owner or access.name,
        asked.ttl,
        force=asked.force,
        origin=origin_of(connection),
    )
    return control_state(services.control, access, lease.key)


@router.patch(
    "/control", dependencies=[OperatorAnyway], responses=problems(409, 413, 422, 423)
)
def renew_control(
    connection: Request,
    request: ControlPatch,
    access: AccessDep,
    services: ServicesDep,
    key: LeaseKey = None,
) -> ControlState:
    """Send a heartbeat, or offer control to another client."""
    lease = services.control.renew(
        access, key, request.ttl, request.hand_over_to, origin_of(connection)
    )
    return control_state(services.control, access, lease.key)


@router.delete("/control", dependencies=[OperatorAnyway], responses=problems(409, 423))
def release_control(
    connection: Request, access: AccessDep, services: ServicesDep, key: LeaseKey = None
) -> ControlState:
    """Give control back; motions go on."""
    services.control.release(access, key, origin_of(connection))
    return control_state(services.control, access, None)


def control_state(
    control: Control, access: Access | None, key: str | None
) -> ControlState:
    """Return the holder of control, with the details that the caller may know.

    Args:
        control: The lease.
        access: Rights of the caller; None for an unknown caller.
        key: Key of the lease that the caller names; None without one.
    """
    lease = control.present()
    if lease is None:
        return ControlState()
    mine = access is not None and lease.is_held_by(access, key)
    return ControlState(
        owner=lease.owner,
        token=lease.access.name,
        since=lease.since,
        ttl=lease.ttl,
        expires_in=max(lease.deadline - time.monotonic(), 0.0),
        hand_over_to=lease.heir,
        mine=mine,
        lease=lease.key if mine else None,
    )


@router.get("/agents/requests", responses=problems())
async def list_agent_requests(services: ServicesDep) -> AgentRequests:
    """List the latest requests of agents, oldest first.

    Waiting requests have no `verdict`.
    """
    return AgentRequests(requests=services.agents.requests())


@router.post(
    "/agents/requests/{number}",
    dependencies=[OperatorAnyway],
    responses=problems(404, 409, 413, 422),
)
async def answer_agent(
    number: str, answer: AgentAnswer, services: ServicesDep, connection: Request
) -> AgentRequest:
    """Allow or refuse a request of an agent; only a person may.

    The answer does not take control from the agent. A request without an answer in time
    is refused.
    """
    return services.agents.decide(
        number, Verdict(answer.verdict), origin_of(connection)
    )
