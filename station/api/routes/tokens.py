"""Named tokens, which the bearer of the station's own token makes and revokes."""

from typing import Annotated

from fastapi import APIRouter, Path, Request

from station.api.audit import origin_of
from station.api.auth import Access
from station.api.dependencies import AccessDep, OperatorAnyway, ServicesDep
from station.api.errors import ProblemError
from station.api.json_route import JsonRoute
from station.api.named_tokens import NamedToken
from station.api.routes.routing import problems
from station.events import EventKind
from station.wire import NewToken, Token, TokenRequest, Tokens
from station.wire.access import TokenName

router = APIRouter(
    prefix="/tokens",
    tags=["access"],
    dependencies=[OperatorAnyway],
    route_class=JsonRoute,
)
Name = Annotated[TokenName, Path(description="Name of the token.", examples=["ada"])]


@router.get("", responses=problems())
async def list_tokens(services: ServicesDep) -> Tokens:
    """List the valid named tokens; the tokens themselves are not kept."""
    return Tokens(
        tokens=[_token(token) for token in services.authenticator.named.all()]
    )


@router.post("", status_code=201, responses=problems(409, 413, 422))
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


@router.delete("/{name}", responses=problems(404, 422))
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
