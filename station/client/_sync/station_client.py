# Generated from _async/station_client.py by tools/generate_client.py.
"""The client of a station: one method per route."""

import math
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Self

import httpx
from pydantic import JsonValue

from station.client._sync.connection import Connection
from station.client._sync.robot_client import RobotClient
from station.client._sync.simulation_client import SimulationClient
from station.client.routes import Restart, Strictness, segment
from station.client.stream import Stream
from station.client.stream_options import Rate, StreamOptions
from station.wire import (
    ArmReport,
    Arms,
    CommandAccepted,
    CommandInfo,
    CommandRequest,
    Controllers,
    ControllerSample,
    ControllerState,
    ControllerType,
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
    Recoveries,
    RecoveryRequest,
    ReleaseRequest,
    Scene,
    SceneObject,
    Session,
    Status,
    StopRequest,
    StopState,
    StreamTicket,
    SwitchRequest,
    SwitchResult,
    TrajectoryRequest,
)
from station.wire.controllers import LOAD_TIMEOUT, SWITCH_BOUND


class StationClient:
    """Talks to a station.

    `StationClient` blocks until the answer is there; `AsyncStationClient` has the same
    methods to be awaited.

    Every method raises `ApiError` when the station refuses, and its child
    `StationUnreachableError` when it does not answer. Arguments that cannot be sent
    at all (NaN, a string for a number) raise pydantic's `ValidationError`, a
    `ValueError`, before anything is sent.

    Proxies and other settings of the environment are not used, because a station is
    near and its token must not travel through a proxy.

    Args:
        url: The station, e.g. `http://127.0.0.1:8000`.
        token: Operator or viewer token; without one only `health` and `ready` work.
        timeout: Longest wait for an answer [s].
        transport: How requests travel; for tests.

    Attributes:
        simulation: Pause, step and reset of a simulated robot.
    """

    def __init__(
        self,
        url: str = "http://127.0.0.1:8000",
        token: str | None = None,
        *,
        timeout: float = 10.0,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        self._connection = Connection(url.rstrip("/"), token, timeout, transport)
        self.simulation = SimulationClient(self._connection)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def url(self) -> str:
        """The station."""
        return self._connection.url

    @property
    def timeout(self) -> float:
        """Longest wait for an answer [s]."""
        return self._connection.timeout

    @timeout.setter
    def timeout(self, timeout: float) -> None:
        self._connection.timeout = timeout

    def move_to(self, url: str, token: str | None) -> None:
        """Talk to another station from the next request on.

        A stream that was opened before goes on with the station it was opened at.

        Args:
            url: The station.
            token: Operator or viewer token.
        """
        self._connection.move_to(url.rstrip("/"), token)

    def close(self) -> None:
        """Close the connections."""
        self._connection.close()

    def health(self) -> Health:
        """Return the boot_id of the process, which lives."""
        return self._connection.get("/health", Health)

    def ready(self) -> Ready:
        """Return when the loop runs with fresh cycles; an error says why not."""
        return self._connection.get("/ready", Ready)

    def session(self) -> Session:
        """Return which role the token has."""
        return self._connection.get("/session", Session)

    def status(self) -> Status:
        """Return the station at a glance."""
        return self._connection.get("/status", Status)

    def hardware(self) -> Hardware:
        """Return interfaces, claims, limits, transmissions and clamps of the robot."""
        return self._connection.get("/hardware", Hardware)

    def controllers(self) -> list[ControllerState]:
        """Return all loaded controllers."""
        return (self._connection.get("/controllers", Controllers)).controllers

    def controller(self, name: str) -> ControllerState:
        """Return one controller."""
        return self._connection.get(_controller(name), ControllerState)

    def load_controller(
        self,
        name: str,
        type: str | None = None,  # noqa: A002 - ros_control's word
        params: Mapping[str, JsonValue] | None = None,
        *,
        timeout: float | None = None,
    ) -> ControllerState:
        """Load a controller; loading the same one again changes nothing.

        Args:
            name: Its name.
            type: Its plugin type; None when the station's configuration has it.
            params: Its parameters; None when the station's configuration has them.
            timeout: How long its import, constructor and init may take [s]; None for
                the station's default.
        """
        given: dict[str, object] = {
            "name": name,
            "type": type,
            "params": params,
            "timeout": timeout,
        }
        request = LoadRequest.model_validate({
            key: value for key, value in given.items() if value is not None
        })
        patience = LOAD_TIMEOUT if timeout is None else timeout
        return self._connection.send(
            "POST", "/controllers", ControllerState, request, patience=patience
        )

    def unload_controller(self, name: str) -> ControllerState:
        """Unload a stopped controller, or cancel its loading; return its last state."""
        path = _controller(name)
        return self._connection.send("DELETE", path, ControllerState)

    def switch_controllers(
        self,
        *,
        start: Sequence[str] = (),
        stop: Sequence[str] = (),
        strictness: Strictness = "strict",
        start_asap: bool = False,
        timeout: float = 0.0,
        bound: float | None = SWITCH_BOUND,
        dry_run: bool = False,
    ) -> SwitchResult:
        """Start and stop controllers in one cycle.

        Args:
            start: Names to start.
            stop: Names to stop.
            strictness: `strict` for all or nothing, `best_effort` for what is possible.
            start_asap: Start each as soon as its joints are ready.
            timeout: How long the hardware may take [s], 0 to 60; 0 means as long as it
                takes, up to `bound`.
            bound: How long a switch without a timeout may take [s of wall time]; None
                means as long as the hardware takes.
            dry_run: Only return what would happen.
        """
        request = SwitchRequest(
            start=list(start),
            stop=list(stop),
            strictness=strictness,
            start_asap=start_asap,
            timeout=timeout,
            bound=bound,
            dry_run=dry_run,
        )
        patience = timeout or (math.inf if bound is None else bound)
        return self._connection.send(
            "POST", "/controllers/switch", SwitchResult, request, patience=patience
        )

    def gains(self, name: str) -> Gains:
        """Return a controller's gains, their units and ranges, and their ETag."""
        return self._connection.get(_controller(name, "gains"), Gains)

    def set_gains(
        self, name: str, values: Mapping[str, float], etag: str | None = None
    ) -> GainsChange:
        """Change gains in one cycle; the others keep their value.

        Args:
            name: The controller.
            values: New values by name, in the units of the schema.
            etag: Refuse when the gains are no longer those of that ETag.
        """
        path, request = _controller(name, "gains"), GainsPatch(values=dict(values))
        headers = {} if etag is None else {"If-Match": etag}
        return self._connection.send(
            "PATCH", path, GainsChange, request, headers=headers
        )

    def last_command(self, name: str) -> CommandInfo:
        """Return the elements of a controller's set-point, and the last set-point."""
        return self._connection.get(_controller(name, "command"), CommandInfo)

    def command(
        self,
        name: str,
        values: Sequence[float],
        epoch: int | None = None,
        timeout: float | None = None,
        rates: Sequence[float] | None = None,
    ) -> CommandAccepted:
        """Send a set-point.

        Args:
            name: The controller.
            values: One number per element, in its order and units.
            epoch: Refuse when a stop or reset came since that epoch.
            timeout: How long it is valid [s], 0 for ever; None for the controller's
                own setting.
            rates: How fast the set-point changes [rad/s or m/s], for controllers that
                feed this forward.
        """
        request = CommandRequest(
            command=list(values),
            epoch=epoch,
            timeout=timeout,
            rates=None if rates is None else list(rates),
        )
        path = _controller(name, "command")
        return self._connection.send("PUT", path, CommandAccepted, request)

    def controller_state(self, name: str) -> ControllerSample:
        """Return what a controller did in the last cycle."""
        return self._connection.get(_controller(name, "state"), ControllerSample)

    def submit_goal(
        self, name: str, goal: Mapping[str, JsonValue], epoch: int | None = None
    ) -> Goal:
        """Give a running controller a goal; it replaces the one before.

        Args:
            name: The controller.
            goal: The goal message of its action, times in seconds.
            epoch: Refuse when a stop or reset came since that epoch.
        """
        path, request = (
            _controller(name, "goals"),
            GoalRequest(goal=dict(goal), epoch=epoch),
        )
        return self._connection.send("POST", path, Goal, request)

    def goals(self, name: str) -> list[Goal]:
        """Return a controller's latest goals, oldest first."""
        return (self._connection.get(_controller(name, "goals"), Goals)).goals

    def goal(self, name: str, goal_id: str) -> Goal:
        """Return a goal: its progress, or how and why it ended."""
        return self._connection.get(_goal(name, goal_id), Goal)

    def cancel_goal(self, name: str, goal_id: str) -> Goal:
        """Cancel a goal; the joints hold from the next cycle on."""
        return self._connection.send("DELETE", _goal(name, goal_id), Goal)

    def follow_trajectory(
        self,
        name: str,
        trajectory: Mapping[str, JsonValue],
        epoch: int | None = None,
    ) -> CommandAccepted:
        """Let a running controller follow a trajectory without a goal.

        Args:
            name: The controller.
            trajectory: A JointTrajectory message, times in seconds; without points the
                joints stop and hold.
            epoch: Refuse when a stop or reset came since that epoch.
        """
        request = TrajectoryRequest(trajectory=dict(trajectory), epoch=epoch)
        path = _controller(name, "trajectory")
        return self._connection.send("POST", path, CommandAccepted, request)

    def query_state(self, name: str, time: float | None = None) -> DesiredState:
        """Return the desired joint state of a trajectory controller.

        Args:
            name: The controller.
            time: Station time [s]; now when None.
        """
        query = None if time is None else {"time": repr(time)}
        path = _controller(name, "query_state")
        return self._connection.get(path, DesiredState, query)

    def joint_states(self) -> JointStates:
        """Return the joints of the last cycle."""
        return self._connection.get("/joint_states", JointStates)

    def controller_types(self) -> list[ControllerType]:
        """Return the types of controllers that can be loaded."""
        return (
            self._connection.get("/controller-types", ControllerTypes)
        ).controller_types

    def robots(self) -> list[ArmReport]:
        """Return all arms with modes and errors, and what to do about the errors."""
        return (self._connection.get("/robots", Arms)).robots

    def recover_all(self, restart: Restart = "none") -> Recoveries:
        """Clear the errors of all arms; with `previous` start controllers again."""
        path, request = "/robots/error_recovery", RecoveryRequest(restart=restart)
        return self._connection.send("POST", path, Recoveries, request, patience=5.0)

    def robot(self, arm_id: str) -> RobotClient:
        """Return the client of one arm."""
        return RobotClient(self._connection, arm_id)

    def scene(self) -> list[SceneObject]:
        """Return the objects around a simulated robot, where they are now."""
        return (self._connection.get("/scene", Scene)).objects

    def loop(self) -> LoopReport:
        """Return state and statistics of the control loop."""
        return self._connection.get("/loop", LoopReport)

    def reset_loop_statistics(self) -> LoopReport:
        """Reset the loop's statistics."""
        return self._connection.send("POST", "/loop/statistics/reset", LoopReport)

    def stop_state(self) -> StopState:
        """Return the state of the latched stop."""
        return self._connection.get("/stop", StopState)

    def stop(self, reason: str = "") -> StopState:
        """Stop the robot; it stays stopped until released.

        Args:
            reason: For the record.
        """
        request = StopRequest(reason=reason)
        return self._connection.send("POST", "/stop", StopState, request)

    def release_stop(self, *, arm: bool = False) -> StopState:
        """Release a stop, in two steps; nothing resumes by itself.

        Args:
            arm: False, first: the cause is gone. True, afterwards: allow motion again.
        """
        request = ReleaseRequest(arm=arm)
        return self._connection.send("POST", "/stop/release", StopState, request)

    def stream_ticket(self) -> StreamTicket:
        """Return a ticket that opens one WebSocket, e.g. for a browser."""
        return self._connection.send("POST", "/stream-tickets", StreamTicket)

    def stream(
        self,
        topic: str,
        *,
        rate: Rate | None = None,
        fields: Sequence[str] = (),
        reconnect: bool = True,
    ) -> Stream:
        """Return a stream of a topic to iterate over, in asyncio with `async for`.

        Args:
            topic: `joint_states`, `controllers`, `loop`, `controller_state/<name>`,
                `robot_state/<arm_id>`.
            rate: Frames per second [Hz], or "full" for every cycle, in batches.
            fields: Only these keys of `data`; all when empty.
            reconnect: Connect again when the link breaks, for ever.
        """
        return Stream(
            StreamOptions(
                self.url, self._connection.token, topic, rate, tuple(fields), reconnect
            )
        )


def _controller(name: str, rest: str = "") -> str:
    path = f"/controllers/{segment(name)}"
    return f"{path}/{rest}" if rest else path


def _goal(name: str, goal_id: str) -> str:
    return f"{_controller(name, 'goals')}/{segment(goal_id)}"
