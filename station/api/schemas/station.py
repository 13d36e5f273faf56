"""Wire models of the station itself: health, status, loop, stop, joints, access."""

from typing import Literal

from pydantic import ConfigDict, Field

from station.api.schemas.base import Measured, RequestModel, ResponseModel
from station.api.schemas.controllers import Percentiles


class Health(ResponseModel):
    """The process lives.

    Attributes:
        status: Always `ok`.
        boot_id: Changes when the station restarts.
    """

    status: Literal["ok"] = "ok"
    boot_id: str


class Ready(ResponseModel):
    """The loop runs and its last cycle is fresh."""

    ready: Literal[True] = True


class LoopReport(ResponseModel):
    """How the control loop does.

    Attributes:
        state: `running`, `stopped` or `failed`.
        failure: Why it failed; empty when it did not.
        rate_hz: Rate asked for [Hz].
        achieved_rate_hz: Rate measured [Hz].
        period: Period asked for [s].
        cycles: Cycles since the start.
        overruns: Cycles that took longer than the period.
        skipped: Deadlines that were skipped.
        real_time_factor: Simulated time over wall time.
        lateness_ms: Wake-up lateness [ms].
        read_us: Time in `read` [us].
        update_us: Time in `update` [us].
        write_us: Time in `write` [us].
        cycle_us: Time of a whole cycle [us].
        scheduler: What the operating system granted.
        controllers: Time per controller [us].
    """

    state: Literal["running", "stopped", "failed"]
    failure: str = ""
    rate_hz: float
    achieved_rate_hz: Measured = None
    period: float
    cycles: int
    overruns: int
    skipped: int
    real_time_factor: Measured = None
    lateness_ms: Percentiles
    read_us: Percentiles
    update_us: Percentiles
    write_us: Percentiles
    cycle_us: Percentiles
    scheduler: str
    controllers: dict[str, Percentiles] = Field(default_factory=dict)


class Status(ResponseModel):
    """The station at a glance.

    Attributes:
        boot_id: Changes when the station restarts.
        epoch: Changes at each stop, reset and recovery.
        time: Station time [s].
        cycle: Number of the last cycle.
        robot_type: Which RobotHW it runs.
        robot_mode: What the robot says it does.
        stop_state: State of the latched stop.
        loop: How the control loop does.
        versions: Versions of the station and what it is built on.
    """

    boot_id: str
    epoch: int
    time: float
    cycle: int
    robot_type: str
    robot_mode: str
    stop_state: str
    loop: LoopReport
    versions: dict[str, str]


class StopRequest(RequestModel):
    """Stop the robot.

    Attributes:
        reason: For the record.
    """

    reason: str = Field(default="", max_length=500)


class StopState(ResponseModel):
    """The latched stop.

    Attributes:
        state: Its state.
        epoch: Present epoch; commands of older ones are void.
    """

    state: str
    epoch: int


class JointStates(ResponseModel):
    """`sensor_msgs/JointState`: one cycle's joints, shape (n,) each.

    Attributes:
        stamp: Station time [s].
        name: Joint names.
        position: Positions [rad] or [m].
        velocity: Velocities [rad/s] or [m/s].
        effort: Efforts [Nm] or [N].
    """

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "stamp": 12.345,
                    "name": ["panda_joint1"],
                    "position": [0.0],
                    "velocity": [0.0],
                    "effort": [0.1],
                }
            ]
        }
    )

    stamp: float
    name: list[str]
    position: list[float]
    velocity: list[float]
    effort: list[float]


class LoginRequest(RequestModel):
    """Exchange a token for a cookie."""

    token: str = Field(min_length=1, max_length=512)


class Session(ResponseModel):
    """Who you are to the station."""

    role: Literal["viewer", "operator"]


class StreamTicket(ResponseModel):
    """Opens one WebSocket, once.

    Attributes:
        ticket: Goes into the query, `?ticket=…`.
        expires_in: How long it is good for [s].
    """

    ticket: str
    expires_in: float
