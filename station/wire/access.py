"""Wire models of named tokens and of the lease of control."""

from typing import Annotated, Literal

from pydantic import Field

from station.reports import AgentRequest
from station.wire.base import Items, RequestModel, ResponseModel

RoleName = Literal["viewer", "agent", "operator"]
PersonName = Annotated[
    str, Field(min_length=1, max_length=100, pattern=r"^[\w][\w.@+ -]*$")
]
"""Name of a person or a program: letters, digits, space, and . _ @ + - inside."""
TokenName = Annotated[
    str, Field(min_length=1, max_length=100, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.@+-]*$")
]
"""A name that is also one segment of a URL."""


class TokenRequest(RequestModel):
    """Make a token for a person or a program.

    Attributes:
        name: Owner of the token: 1 to 100 letters, digits, or one of . _ @ + - inside.
        role: `viewer`: read everything and stop the robot; `agent`: ask for motion as
            well, within the agents' envelope; `operator`: everything.
        expires: How long it is valid [s], 1 or more; null until it is revoked.

    Example:
        {"name": "ada", "role": "operator", "expires": 86400.0}
    """

    name: TokenName
    role: RoleName = "operator"
    expires: float | None = Field(default=None, ge=1.0, le=1e9)


class Token(ResponseModel):
    """A named token, without the token itself.

    Attributes:
        name: Owner of the token.
        role: Role, which decides on its rights.
        created: Wall time when it was made [s since 1970].
        expires_at: Wall time when it ends [s since 1970]; null when it does not.
    """

    name: str
    role: RoleName
    created: float
    expires_at: float | None


class NewToken(Token):
    """A named token that was just made; the token cannot be read again.

    Attributes:
        token: The token, for `Authorization: Bearer …`.
    """

    token: str


class Tokens(ResponseModel):
    """The named tokens.

    Attributes:
        tokens: The valid ones, oldest first.
    """

    tokens: Items[Token]


class AgentRequests(ResponseModel):
    """The requests of agents.

    Attributes:
        requests: The latest ones, oldest first.
    """

    requests: Items[AgentRequest]


class AgentAnswer(RequestModel):
    """Answer a request of an agent.

    Attributes:
        verdict: `allowed`; `allowed_for_a_time`: this one, and all that the agent asks
            for in the next 10 min, until control changes hands or the robot is stopped;
            `refused`.

    Example:
        {"verdict": "allowed"}
    """

    verdict: Literal["allowed", "allowed_for_a_time", "refused"]


class ControlRequest(RequestModel):
    """Take control, or keep it.

    Attributes:
        owner: Name of the new holder, 1 to 100 characters; others see it. The
            name of the token when left out.
        ttl: How long the lease lasts without a heartbeat [s], 0.5 to 3600.
        force: Take control from its holder; an event records it.

    Example:
        {"owner": "ada", "ttl": 10.0}
    """

    owner: PersonName | None = None
    ttl: float = Field(default=10.0, ge=0.5, le=3600.0)
    force: bool = False


class ControlPatch(RequestModel):
    """A heartbeat of the owner, or an offer to hand control over.

    Attributes:
        ttl: How long the lease lasts from now on without a heartbeat [s], 0.5 to 3600;
            as before when null.
        hand_over_to: Owner or named token that may take control without force, 1 to
            100 characters; as before when null.

    Example:
        {"hand_over_to": "grace"}
    """

    ttl: float | None = Field(default=None, ge=0.5, le=3600.0)
    hand_over_to: PersonName | None = None


class ControlState(ResponseModel):
    """Control of the station, and its holder.

    Attributes:
        owner: Name of the owner; null while no client holds control, and every operator
            may change things.
        token: Name of the token that the owner uses; null without an owner.
        since: Wall time since when [s since 1970]; null without an owner.
        ttl: How long the lease lasts without a heartbeat [s]; null without an owner.
        expires_in: How long the lease still lasts [s], 0 or more; null without an
            owner.
        hand_over_to: Name that may take control without force; null without an offer.
        mine: Whether the caller holds control.
        lease: Only in answers to the owner: goes into the header `X-Control-Lease` of
            the owner's requests; null in others.
    """

    owner: str | None = None
    token: str | None = None
    since: float | None = None
    ttl: float | None = None
    expires_in: float | None = None
    hand_over_to: str | None = None
    mine: bool = False
    lease: str | None = None
