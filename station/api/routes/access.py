"""Access: cookies for browsers, tickets for WebSockets, and named tokens.

The bearer of the station's own token makes and revokes named tokens.
"""

from typing import Annotated

from fastapi import APIRouter, Path, Query, Request, Response
from fastapi.responses import RedirectResponse

from station.api.audit import origin_of
from station.api.auth import (
    SESSION_LIFETIME,
    TICKET_LIFETIME,
    Access,
    Authenticator,
    Role,
)
from station.api.dependencies import AccessDep, OperatorAnyway, ServicesDep
from station.api.errors import ProblemError
from station.api.json_route import JsonRoute
from station.api.named_tokens import NamedToken
from station.api.routes.routing import ApiRouter, problems
from station.api.services import Services
from station.events import EventKind
from station.wire import (
    LoginRequest,
    NewToken,
    Session,
    StreamTicket,
    Token,
    TokenRequest,
    Tokens,
)
from station.wire.station import TokenName

router = ApiRouter(tags=["access"], route_class=JsonRoute)
login_page = APIRouter(include_in_schema=False)
tokens = ApiRouter(
    "/tokens",
    tags=["access"],
    dependencies=[OperatorAnyway],
    route_class=JsonRoute,
)
Name = Annotated[TokenName, Path(description="Name of the token.", examples=["ada"])]


async def _access_of(request: Request, services: Services, token: str) -> Access:
    access = services.authenticator.access_of_token(token)
    if access is None:
        services.event_recorder.failed_login(request)
        await services.failed_logins.slow_down(request)
        raise ProblemError(
            401,
            "unauthorized",
            "That is not a token of this station.",
            "Use the token that the station printed when it was started; every start "
            "makes a new one.",
        )
    if access.role is Role.AGENT:
        raise ProblemError(
            403,
            "person_needed",
            f"{access.name} is an agent, and browsers are for people.",
            "Send the token with each request: Authorization: Bearer <token>.",
        )
    services.event_recorder.login(request, access, "login")
    return access


def _set_cookie(
    request: Request, response: Response, authenticator: Authenticator, access: Access
) -> None:
    response.set_cookie(
        authenticator.cookie_name,
        authenticator.open_session(access.role, access.token),
        max_age=int(SESSION_LIFETIME),
        path="/",
        httponly=True,
        samesite="strict",
        # Over plain HTTP browsers do not send a secure cookie back.
        secure=request.url.scheme == "https",
    )


@router.post("/login", responses=problems(413, 422))
async def login(
    body: LoginRequest,
    request: Request,
    response: Response,
    services: ServicesDep,
) -> Session:
    """Exchange a token for a session cookie (SameSite=Strict, HttpOnly)."""
    access = await _access_of(request, services, body.token)
    _set_cookie(request, response, services.authenticator, access)
    return Session(role=access.role.value, name=access.name)


@router.post("/logout", status_code=204, responses=problems())
async def logout(
    request: Request,
    response: Response,
    services: ServicesDep,
) -> None:
    """Revoke the session cookie, and end the streams of the session."""
    authenticator = services.authenticator
    access = authenticator.access_of_headers(request.headers)
    if access is not None and access.session is not None:
        services.event_recorder.login(request, access, "logout")
    authenticator.close_session(authenticator.session_of(request.headers))
    response.delete_cookie(
        authenticator.cookie_name, path="/", httponly=True, samesite="strict"
    )


@router.get("/session", responses=problems())
async def session(access: AccessDep) -> Session:
    """Return the caller's role and name."""
    return Session(role=access.role.value, name=access.name)


@router.post("/stream-tickets", responses=problems())
async def issue_ticket(access: AccessDep, services: ServicesDep) -> StreamTicket:
    """Return a ticket that opens one WebSocket soon: `?ticket=…`."""
    return StreamTicket(
        ticket=services.authenticator.issue_ticket(access), expires_in=TICKET_LIFETIME
    )


@login_page.get("/login")
async def login_by_link(
    request: Request,
    services: ServicesDep,
    token: str,
    target: Annotated[str, Query(alias="next")] = "/docs",
) -> Response:
    """Log a browser in by the link that the station has printed, and show a page."""
    access = await _access_of(request, services, token)
    # A target on another site would let an attacker send people there by the login
    # page. Browsers read // and /\\ as the beginning of a host name.
    own = target.startswith("/") and not target.startswith(("//", "/\\"))
    response = RedirectResponse(target if own else "/docs", status_code=303)
    _set_cookie(request, response, services.authenticator, access)
    return response


@tokens.get("", responses=problems())
async def list_tokens(services: ServicesDep) -> Tokens:
    """List the valid named tokens; the tokens themselves are not kept."""
    return Tokens(
        tokens=[_token(token) for token in services.authenticator.named.all()]
    )


@tokens.post("", status_code=201, responses=problems(409, 413, 422))
async def create_token(
    request: TokenRequest,
    connection: Request,
    access: AccessDep,
    services: ServicesDep,
) -> NewToken:
    """Make a token for a person or a program; only this answer contains it.

    This needs the station's own operator token: otherwise a revoked named token could
    live on in tokens that it has made.
    """
    _check_own(access)
    named = services.authenticator.named
    secret = await named.create(request.name, request.role, request.expires)
    token = named.get(request.name)
    services.event_recorder.log.record(
        EventKind.TOKEN,
        f"A token for {token.name} ({token.role}) was made.",
        what=token.name,
        result="created",
        details={"role": token.role, "expires_at": token.expires},
        origin=origin_of(connection),
    )
    return NewToken(**_token(token).model_dump(), token=secret)


@tokens.delete("/{name}", responses=problems(404, 422))
async def revoke_token(
    name: Name,
    connection: Request,
    access: AccessDep,
    services: ServicesDep,
) -> Token:
    """Revoke a token; its sessions, streams and lease of control end at once."""
    _check_own(access)
    token = await services.authenticator.named.revoke(name)
    services.event_recorder.log.record(
        EventKind.TOKEN,
        f"The token of {name} was revoked.",
        what=name,
        result="revoked",
        origin=origin_of(connection),
    )
    return _token(token)


def _check_own(access: Access) -> None:
    """Refuse a caller with a named token.

    Raises:
        ProblemError: The caller has a named token.
    """
    if access.token is not None:
        raise ProblemError(
            403,
            "own_token_needed",
            f"The token of '{access.name}' cannot make or revoke tokens.",
            "Use the operator token that the station printed at its start.",
        )


def _token(token: NamedToken) -> Token:
    return Token.model_validate({
        "name": token.name,
        "role": token.role,
        "created": token.created,
        "expires_at": token.expires,
    })
