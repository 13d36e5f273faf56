"""Dependencies of routes: the station, its arms, and the role of the caller."""

import asyncio
import time
from collections.abc import Awaitable, Callable, Mapping
from functools import wraps
from inspect import Parameter, signature
from math import isfinite, nan
from typing import Annotated, Any

from fastapi import Depends, Header, Request, Security
from fastapi.concurrency import run_in_threadpool
from fastapi.security import HTTPBearer

from station.api.agents import REHEARSED
from station.api.audit import note_access, origin_of
from station.api.auth import Access, Role
from station.api.errors import ProblemError
from station.api.services import Services, services_of
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from station.core.franka.gripper_services import Grippers
from station.wire.protocol import CLOCK_HEADER, LEASE_HEADER, NOT_AFTER_HEADER

_bearer = HTTPBearer(
    auto_error=False,
    description="The operator or viewer token that the station printed at its start. "
    "Browsers may log in instead and send the session cookie.",
)


async def get_services(request: Request) -> Services:
    """Return the services of the app."""
    return services_of(request)


ServicesDep = Annotated[Services, Depends(get_services)]


async def get_station(services: ServicesDep) -> Station:
    """Return the station that the app serves."""
    return services.station


StationDep = Annotated[Station, Depends(get_station)]


async def get_arms(station: StationDep) -> Arms:
    """Return the Franka arms of the station."""
    return Arms(station.robots)


async def get_grippers(station: StationDep) -> Grippers:
    """Return the grippers of the station's Franka arms."""
    return Grippers(station.robots)


ArmsDep = Annotated[Arms, Depends(get_arms)]
GrippersDep = Annotated[Grippers, Depends(get_grippers)]


async def access(
    request: Request,
    services: ServicesDep,
    _: Annotated[object, Security(_bearer)] = None,
) -> Access:
    """Return the rights of the caller, and their proof.

    Raises:
        ProblemError: The request has no valid token and no valid session.
    """
    found = services.authenticator.access_of_headers(request.headers)
    if found is None:
        if "authorization" in request.headers:
            services.event_recorder.failed_login(request)
            await services.failed_logins.slow_down(request)
        raise ProblemError(
            401,
            "unauthorized",
            "The request carries no token or session that this station knows.",
            "Send 'Authorization: Bearer <token>' with the token that the station "
            "printed at its start, or log in at /login?token=<token>.",
            {"WWW-Authenticate": "Bearer"},
        )
    note_access(request, found)
    return found


AccessDep = Annotated[Access, Depends(access)]


async def viewer(access: AccessDep) -> Role:
    """Return the caller's role."""
    return access.role


RoleDep = Annotated[Role, Depends(viewer)]


async def operator_anyway(
    request: Request, role: RoleDep, access: AccessDep, services: ServicesDep
) -> Role:
    """Return the role of a caller who may make changes, regardless of control.

    Raises:
        ProblemError: The caller is a viewer, an agent that may not call the operation,
            or the request comes too late.
    """
    if role is Role.AGENT:
        services.agents.check(request.scope["route"].name, access)
    elif not role.includes(Role.OPERATOR):
        raise ProblemError(
            403,
            "operator_needed",
            f"A {role.value} may read and stop, but not change anything else.",
            "Use the operator token.",
        )
    refuse_late(request.headers)
    return role


LeaseKey = Annotated[
    str | None,
    Header(
        alias=LEASE_HEADER,
        max_length=100,
        examples=["kCbBNd9xZ2u8"],
        description="The lease of control that the request acts under, from the answer "
        "of POST /control.",
    ),
]


async def operator(
    request: Request,
    role: Annotated[Role, Depends(operator_anyway)],
    access: AccessDep,
    services: ServicesDep,
) -> Role:
    """Return the role of a caller who may make changes now.

    Raises:
        ControlHeldError: Another client holds control.
        ControlNotHeldError: The caller is an agent without a lease.
        RehearsalNeededError: The caller is an agent whose motion has no certificate.
        CertificateNotFoundError: The certificate of an agent's motion is unknown,
            expired or used up.
        CertificateVoidError: The certificate of an agent's motion is void.
    """
    services.control.check(access, request.headers.get(LEASE_HEADER))
    if role is Role.AGENT and request.scope["route"].name in REHEARSED:
        # Check the certificate before a person is asked, so that no allowed request is
        # refused afterwards.
        certificate = request.query_params.get("certificate")
        await run_in_threadpool(services.rehearsals.check_agent, certificate)
    return role


Leave = Callable[[], Awaitable[None]]


async def leave(request: Request, access: AccessDep, services: ServicesDep) -> Leave:
    """Return a dependency that waits until a person allows an agent's request."""
    key = request.headers.get(LEASE_HEADER)

    async def wait() -> None:
        if access.role is Role.AGENT:
            # Renew the agent's lease, because an agent that waits for an answer sends
            # no heartbeat.
            keeping = asyncio.create_task(services.control.keep(access, key))
            try:
                await services.agents.admit(request, access, origin_of(request))
            finally:
                keeping.cancel()
            # A person may have taken control in the meantime.
            services.control.check(access, key)

    return wait


def with_leave(operation: Callable[..., object]) -> Callable[..., Any]:
    """Return an operation that waits until a person allows it, if an agent calls it.

    It waits after the whole request is read. In a dependency it would wait earlier, and
    a person would be asked about requests that are malformed.

    Args:
        operation: A function that a worker thread runs.
    """

    @wraps(operation)
    async def call(leave: Leave, **arguments: object) -> object:
        await leave()
        return await run_in_threadpool(operation, **arguments)

    kind = Annotated[Leave, Depends(leave)]
    own = signature(operation)
    added = Parameter("leave", Parameter.KEYWORD_ONLY, annotation=kind)
    parameters = [*own.parameters.values(), added]
    call.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]  # read by the framework
    return call


Viewer = Depends(viewer)
Operator = Depends(operator)
OperatorAnyway = Depends(operator_anyway)


def refuse_late(
    headers: Mapping[str, str], now: Callable[[], float] = time.time
) -> None:
    """Refuse a request that comes too late.

    Args:
        headers: Headers of the request; without `X-Not-After` it is never too late.
        now: Wall clock [s since 1970].

    Raises:
        ProblemError: The request comes too late, or the header is not a number.
    """
    latest = headers.get(NOT_AFTER_HEADER)
    if latest is None:
        return
    try:
        late = now() - float(latest)
    except ValueError:
        late = nan
    if not isfinite(late):
        raise ProblemError(
            422,
            "invalid_request",
            f"{NOT_AFTER_HEADER} is {latest!r:.40}; it is seconds since 1970.",
            f"Add to {CLOCK_HEADER} of the last answer, or leave it out.",
        )
    if late > 0.0:
        raise ProblemError(
            412,
            "expired",
            f"The request came {late:.1f} s too late to be begun, for example because "
            "the station stood still. Nothing was done.",
            "Look at the robot, then ask again.",
        )
