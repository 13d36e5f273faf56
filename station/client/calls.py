"""Every route of the API as a value: how to ask, and what the answer is.

Both clients send these, so that a route is written down once.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, Literal, TypeVar
from urllib.parse import quote

from pydantic import BaseModel, JsonValue

from station.client.errors import ApiError
from station.wire import (
    CommandAccepted,
    CommandInfo,
    CommandRequest,
    Controllers,
    ControllerSample,
    ControllerState,
    ControllerTypes,
    DesiredState,
    Gains,
    GainsChange,
    GainsPatch,
    Goal,
    GoalRequest,
    Goals,
    Hardware,
    Health,
    JointStates,
    LoadRequest,
    LoopReport,
    Ready,
    ReleaseRequest,
    ResetRequest,
    Scene,
    Session,
    Simulation,
    SimulationPatch,
    Status,
    StepRequest,
    StopRequest,
    StopState,
    StreamTicket,
    SwitchRequest,
    SwitchResult,
    TrajectoryRequest,
)

PREFIX = "/api/v1"
Strictness = Literal["strict", "best_effort"]
ModelT = TypeVar("ModelT", bound=BaseModel)


@dataclass(frozen=True, slots=True)
class Call(Generic[ModelT]):
    """One request.

    Attributes:
        method: HTTP method.
        path: Path with prefix.
        model: What the answer is.
        body: JSON body; None for none.
        headers: Extra headers.
        patience: How much longer than usual the answer may take [s].
    """

    method: str
    path: str
    model: type[ModelT]
    body: bytes | None = None
    headers: Mapping[str, str] = field(default_factory=dict)
    patience: float = 0.0

    def sent_headers(self) -> dict[str, str]:
        """Return the extra headers, and what the body is."""
        kind = {} if self.body is None else {"Content-Type": "application/json"}
        return {**self.headers, **kind}

    def read_answer(self, status: int, body: bytes) -> ModelT:
        """Return what the station has answered.

        Args:
            status: HTTP status.
            body: The answer's body.

        Raises:
            ApiError: The station refuses.
        """
        if not 200 <= status < 300:
            refusal = ApiError.from_body(status, body)
            raise refusal
        return self.model.model_validate_json(body)


def _get(path: str, model: type[ModelT]) -> Call[ModelT]:
    return Call("GET", PREFIX + path, model)


def _send(
    method: str,
    path: str,
    model: type[ModelT],
    body: BaseModel | None = None,
    *,
    headers: Mapping[str, str] | None = None,
    patience: float = 0.0,
) -> Call[ModelT]:
    content = None
    if body is not None:
        content = body.model_dump_json(exclude_unset=True).encode()
    return Call(method, PREFIX + path, model, content, dict(headers or {}), patience)


def _controller(name: str, rest: str = "") -> str:
    return f"/controllers/{quote(name, safe='')}{rest}"


def health() -> Call[Health]:
    """Ask whether the process lives."""
    return _get("/health", Health)


def ready() -> Call[Ready]:
    """Ask whether the loop runs."""
    return _get("/ready", Ready)


def session() -> Call[Session]:
    """Ask which role the token has."""
    return _get("/session", Session)


def status() -> Call[Status]:
    """Ask for the station at a glance."""
    return _get("/status", Status)


def hardware() -> Call[Hardware]:
    """Ask what the robot has, who claims it and what limits it."""
    return _get("/hardware", Hardware)


def controllers() -> Call[Controllers]:
    """Ask for all controllers."""
    return _get("/controllers", Controllers)


def controller(name: str) -> Call[ControllerState]:
    """Ask for one controller."""
    return _get(_controller(name), ControllerState)


def load_controller(
    name: str, type_: str | None, params: Mapping[str, JsonValue] | None
) -> Call[ControllerState]:
    """Ask to load a controller."""
    body = LoadRequest.model_validate({
        "name": name,
        **({} if type_ is None else {"type": type_}),
        **({} if params is None else {"params": dict(params)}),
    })
    return _send("POST", "/controllers", ControllerState, body)


def unload_controller(name: str) -> Call[ControllerState]:
    """Ask to unload a controller; the answer is what it was."""
    return _send("DELETE", _controller(name), ControllerState)


def switch_controllers(request: SwitchRequest) -> Call[SwitchResult]:
    """Ask to start and stop controllers in one cycle."""
    return _send(
        "POST",
        "/controllers/switch",
        SwitchResult,
        request,
        patience=request.timeout,
    )


def gains(name: str) -> Call[Gains]:
    """Ask for a controller's gains."""
    return _get(_controller(name, "/gains"), Gains)


def set_gains(
    name: str, values: Mapping[str, float], etag: str | None
) -> Call[GainsChange]:
    """Ask to change gains."""
    headers = {} if etag is None else {"If-Match": etag}
    body = GainsPatch(values=dict(values))
    return _send(
        "PATCH", _controller(name, "/gains"), GainsChange, body, headers=headers
    )


def last_command(name: str) -> Call[CommandInfo]:
    """Ask what set-points a controller takes and which it took last."""
    return _get(_controller(name, "/command"), CommandInfo)


def command(
    name: str,
    values: Sequence[float],
    epoch: int | None,
    timeout: float | None,
    rates: Sequence[float] | None = None,
) -> Call[CommandAccepted]:
    """Send a set-point."""
    body = CommandRequest(
        command=list(values),
        epoch=epoch,
        timeout=timeout,
        rates=None if rates is None else list(rates),
    )
    return _send("PUT", _controller(name, "/command"), CommandAccepted, body)


def controller_state(name: str) -> Call[ControllerSample]:
    """Ask what a controller did in the last cycle."""
    return _get(_controller(name, "/state"), ControllerSample)


def submit_goal(
    name: str, goal: Mapping[str, JsonValue], epoch: int | None
) -> Call[Goal]:
    """Send a goal."""
    body = GoalRequest(goal=dict(goal), epoch=epoch)
    return _send("POST", _controller(name, "/goals"), Goal, body)


def goals(name: str) -> Call[Goals]:
    """Ask for a controller's latest goals."""
    return _get(_controller(name, "/goals"), Goals)


def goal(name: str, goal_id: str) -> Call[Goal]:
    """Ask how far a goal is."""
    return _get(_controller(name, f"/goals/{quote(goal_id, safe='')}"), Goal)


def cancel_goal(name: str, goal_id: str) -> Call[Goal]:
    """Ask for the end of a goal."""
    path = _controller(name, f"/goals/{quote(goal_id, safe='')}")
    return _send("DELETE", path, Goal)


def follow_trajectory(
    name: str, trajectory: Mapping[str, JsonValue], epoch: int | None
) -> Call[CommandAccepted]:
    """Send a trajectory for which nobody waits."""
    body = TrajectoryRequest(trajectory=dict(trajectory), epoch=epoch)
    return _send("POST", _controller(name, "/trajectory"), CommandAccepted, body)


def query_state(name: str, time: float | None) -> Call[DesiredState]:
    """Ask where the joints of a trajectory controller shall be."""
    query = "" if time is None else f"?time={time!r}"
    return _get(_controller(name, f"/query_state{query}"), DesiredState)


def joint_states() -> Call[JointStates]:
    """Ask for the joints of the last cycle."""
    return _get("/joint_states", JointStates)


def controller_types() -> Call[ControllerTypes]:
    """Ask for the plugins."""
    return _get("/controller-types", ControllerTypes)


def loop() -> Call[LoopReport]:
    """Ask how the loop does."""
    return _get("/loop", LoopReport)


def reset_loop_statistics() -> Call[LoopReport]:
    """Ask to start the loop's statistics afresh."""
    return _send("POST", "/loop/statistics/reset", LoopReport)


def scene() -> Call[Scene]:
    """Ask for the things around a simulated robot."""
    return _get("/scene", Scene)


def simulation() -> Call[Simulation]:
    """Ask whether time passes, and how fast."""
    return _get("/simulation", Simulation)


def change_simulation(
    *, paused: bool | None = None, real_time_factor: float | None = None
) -> Call[Simulation]:
    """Ask to pause, to resume, or to change the pace."""
    given = {"paused": paused, "real_time_factor": real_time_factor}
    body = SimulationPatch.model_validate({
        name: value for name, value in given.items() if value is not None
    })
    return _send("PATCH", "/simulation", Simulation, body)


def step_simulation(n: int) -> Call[Simulation]:
    """Ask to run some cycles of a paused simulation."""
    body = StepRequest(n=n)
    return _send("POST", "/simulation/step", Simulation, body, patience=0.1 * n)


def reset_simulation(joint_positions: Mapping[str, float]) -> Call[Simulation]:
    """Ask to put the world back to its start."""
    body = ResetRequest(joint_positions=dict(joint_positions))
    return _send("POST", "/simulation/reset", Simulation, body)


def stop_state() -> Call[StopState]:
    """Ask for the state of the latched stop."""
    return _get("/stop", StopState)


def stop(reason: str) -> Call[StopState]:
    """Ask to stop the robot."""
    return _send("POST", "/stop", StopState, StopRequest(reason=reason))


def release_stop(*, arm: bool) -> Call[StopState]:
    """Ask to release the stop, or to allow motion again."""
    return _send("POST", "/stop/release", StopState, ReleaseRequest(arm=arm))


def stream_ticket() -> Call[StreamTicket]:
    """Ask for a ticket that opens one WebSocket."""
    return _send("POST", "/stream-tickets", StreamTicket)
