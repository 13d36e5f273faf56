"""Wire models of the station itself: health, status, loop, stop, joints, access."""

from typing import Annotated, Literal

from pydantic import Field

from station.reports import LoopReport, Simulation
from station.wire.access import RoleName
from station.wire.base import (
    FromEnum,
    Items,
    Measurements,
    Reason,
    RequestModel,
    ResponseModel,
)
from station.wire.events import EventLogState
from station.wire.hardware import Clamp
from station.wire.recordings import Recording
from station.wire.robots import ArmReport

StopStateName = Annotated[Literal["armed", "stopped", "released"], FromEnum]


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
