"""Wire models of the station itself: health, status, loop, stop, joints, access.

Access is logins, named tokens and the lease of control.
"""

from typing import Annotated, Literal

from pydantic import Field

from station.reports import AgentRequest, LoopReport, Simulation
from station.wire.base import (
    FromEnum,
    Items,
    Measurements,
    Reason,
    RequestModel,
    ResponseModel,
)
from station.wire.records import EventLogState, Recording
from station.wire.robots import ArmReport, Clamp

RoleName = Literal["viewer", "agent", "operator"]
PersonName = Annotated[
    str, Field(min_length=1, max_length=100, pattern=r"^[\w][\w.@+ -]*$")
]
"""Name of a person or a program: letters, digits, space, and . _ @ + - inside."""
TokenName = Annotated[
    str, Field(min_length=1, max_length=100, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.@+-]*$")
]
"""A name that is also one segment of a URL."""
StopStateName = Annotated[Literal["armed", "stopped", "released"], FromEnum]


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


class Health(ResponseModel):
    """The process lives.

    Attributes:
        status: Always `ok`.
        boot_id: Changes when the station restarts.
    """

    status: Literal["ok"] = "ok"
    boot_id: str


class Ready(ResponseModel):
    """The loop runs and its last cycle is fresh.

    Attributes:
        ready: Always true; otherwise the answer is 503 with the reason.
    """

    ready: Literal[True] = True


class Kernel(ResponseModel):
    """Implementation of the control cycle that runs: compiled or interpreted.

    Attributes:
        mode: `compiled`: compiled modules; `interpreted`: their Python sources.
        reason: Why this mode runs, and how to change it.
    """

    mode: Literal["compiled", "interpreted"]
    reason: Reason


class CommandViolations(ResponseModel):
    """Commands written without a claim on their resource; the station rests them.

    Attributes:
        count: How many there were.
        last: Description of the last of these commands; empty without one.
    """

    count: int = 0
    last: Reason = ""


class Status(ResponseModel):
    """The station at a glance.

    Attributes:
        boot_id: Changes when the station restarts.
        epoch: Changes at each stop, reset and recovery.
        time: Station time [s].
        cycle: Number of the last cycle.
        robot_type: Type of its RobotHW.
        robot_label: `SIMULATION`, or `REAL ARM` with its address, or `REAL ROBOT` of a
            robot without an address; empty from an older station.
        robot_mode: Mode of the robot in one word.
        stop_state: State of the latched stop.
        stop_reason: Why it was engaged last.
        loop: State and statistics of the control loop.
        kernel: Whether the arithmetic of the cycle runs interpreted or compiled; null
            from an older station.
        simulation: How simulated time passes; null for a real robot.
        robots: The arms with their modes and errors.
        versions: Versions of the station and of the packages below it.
        clamps: Commands that limits cut off; empty if none ever was.
        command_violations: Commands that were written without a claim.
        events: State of the event log; null from an older station.
        operator: Name of the holder of control; null without one.
        recording: The running recording, or else the last one since the start of the
            station, also when it failed; null without one.
        recorder_failure: Why the station has stopped recording, or could not keep an
            incident; empty while all is well.
    """

    boot_id: str
    epoch: int
    time: float
    cycle: int
    robot_type: str
    robot_label: str = ""
    robot_mode: str
    stop_state: StopStateName
    stop_reason: Reason
    loop: LoopReport
    kernel: Kernel | None = None
    simulation: Simulation | None = None
    robots: Items[ArmReport] = Field(default_factory=list)
    versions: dict[str, str]
    clamps: Items[Clamp] = Field(default_factory=list)
    command_violations: CommandViolations = Field(default_factory=CommandViolations)
    events: EventLogState | None = None
    operator: str | None = None
    recording: Recording | None = None
    recorder_failure: Reason = ""


class StopRequest(RequestModel):
    """Stop the robot.

    Attributes:
        reason: Reason, which the station records.

    Example:
        {"reason": "Somebody is in the cell."}
    """

    reason: str = Field(default="", max_length=500)


class ReleaseRequest(RequestModel):
    """Release a stop, in two steps.

    Attributes:
        arm: False, first: the cause is gone. True, afterwards: allow motion again.

    Example:
        {"arm": true}
    """

    arm: bool = False


class StopState(ResponseModel):
    """The latched stop.

    Attributes:
        state: `armed`: motion is possible; `stopped`: nothing may move; `released`:
            the cause is gone, motion must still be armed.
        reason: Why it was engaged last; empty if it never was.
        epoch: Present epoch; commands of older ones are void.
        pending: Whether the stop is engaged but not yet carried out by a cycle, which
            will change the epoch.
    """

    state: StopStateName
    reason: Reason
    epoch: int
    pending: bool = False


class JointStates(ResponseModel):
    """States of the joints in one cycle, as `sensor_msgs/JointState`; shape (n,) each.

    Attributes:
        stamp: Station time [s].
        name: Joint names.
        position: Positions [rad] or [m]; null where a reading is not finite.
        velocity: Velocities [rad/s] or [m/s].
        effort: Efforts [Nm] or [N].

    Example:
        {"stamp": 12.345, "name": ["panda_joint1"], "position": [0.0], "velocity":
         [0.0], "effort": [0.1]}
    """

    stamp: float
    name: Items[str]
    position: Measurements
    velocity: Measurements
    effort: Measurements


class LoginRequest(RequestModel):
    """Exchange a token for a cookie.

    Attributes:
        token: The operator's or the viewer's token of this start of the station.

    Example:
        {"token": "the token that the station printed"}
    """

    token: str = Field(min_length=1, max_length=512)


class Session(ResponseModel):
    """The role that the station grants the caller.

    Attributes:
        role: `viewer`: read everything and stop the robot; `agent`: ask for motion as
            well; `operator`: everything.
        name: Name of the token: the role, or that of a named token.
    """

    role: RoleName
    name: str = ""


class StreamTicket(ResponseModel):
    """A ticket that opens one WebSocket, once.

    Attributes:
        ticket: Text for the query of the WebSocket's address, `?ticket=…`.
        expires_in: How long it is valid [s].
    """

    ticket: str
    expires_in: float
