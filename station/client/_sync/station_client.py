# Generated from _async/station_client.py by tools/generate_client.py.
"""The client of a station: one method per route."""

import ssl
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Literal, Self

import httpx
from pydantic import JsonValue

from station import wire
from station.client._sync.collecting import collect
from station.client._sync.connection import Connection
from station.client._sync.control_lease import ControlLease
from station.client._sync.controller_changes import load, switch, unload
from station.client._sync.goal_handle import GoalHandle
from station.client._sync.lease_client import LeaseClient
from station.client._sync.motion import move_to, start_move
from station.client._sync.recordings_client import kept_by_station
from station.client._sync.robot_client import RobotClient
from station.client._sync.simulation_client import SimulationClient
from station.client._sync.tokens_client import TokensClient
from station.client.command_stream import CommandStream
from station.client.notebook import describe
from station.client.poses import Pose, Target
from station.client.promptness import Promptness
from station.client.routes import (
    Restart,
    Strictness,
    controller_path,
    event_query,
    goal_path,
    load_request,
    segment,
)
from station.client.samples import Samples
from station.client.stream import Stream
from station.client.stream_options import Rate
from station.local.station_locator import locate
from station.local.tls import trust
from station.wire.bench import BenchRequest, BenchResponse, Excitation
from station.wire.controllers import SWITCH_BOUND


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
        url: The station, e.g. `http://127.0.0.1:8000`. When None it is `STATION_URL`,
            or else the only station of this user that runs on this machine.
        token: Operator or viewer token. When None it is `STATION_TOKEN`, or else that
            of a station on this machine; without one only `health` and `ready` work.
        timeout: Longest wait for an answer [s].
        transport: How requests travel; for tests.
        ca: PEM file with the certificates to trust with an https `url`. When None it is
            `STATION_CA`, or else the certificate of the station on this machine, or
            else what the system trusts.

    Raises:
        NoStationError: No `url`, and no station or several on this machine.
        TlsFilesError: The certificates to trust cannot be read.

    Attributes:
        simulation: Pause, step and reset of a simulated robot.
        gain_sets: Named sets of gains on the station's disk.
        waypoint_paths: Waypoint paths on the station's disk, and their playing.
        tokens: Named tokens of people and programs.
        alarms: What asks for a person, and who has seen it.
        lease: Control, taken and given back call by call; see also `control`.
        recordings: Recordings of every cycle on the station's disk.
        incidents: What the station kept of stops, reflexes and faults.
        experiments: Many trials of a simulated copy of the station.
    """

    def __init__(
        self,
        url: str | None = None,
        token: str | None = None,
        *,
        timeout: float = 10.0,
        transport: httpx.BaseTransport | None = None,
        ca: str | None = None,
    ) -> None:
        url, token = locate(url, token)
        self._connection = Connection(
            url.rstrip("/"), token, timeout, transport, trust(url, ca)
        )
        self.simulation = SimulationClient(self._connection)
        kept = kept_by_station(self._connection)
        self.gain_sets, self.recordings, self.incidents = kept[:3]
        self.experiments, self.waypoint_paths, self.alarms = kept[3:]
        self.tokens = TokensClient(self._connection)
        self.lease = LeaseClient(self._connection)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _repr_html_(self) -> str:
        """Return what a notebook shows: the station and where it is looked at."""
        return describe(self.url, self._connection.token, tls=self._connection.tls)

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

    def begin_within(self, promptness: Promptness | None) -> None:
        """Let the station refuse changes that it would begin too late.

        Args:
            promptness: Until when, from the next request on; may be shared by several
                clients of one station. None lets a change begin however late it comes.
        """
        self._connection.promptness = promptness

    @property
    def tls(self) -> ssl.SSLContext | None:
        """How the station's certificate is checked; None for plain HTTP."""
        return self._connection.tls

    def talk_to(self, url: str, token: str | None) -> None:
        """Talk to another station from the next request on.

        A stream that was opened before goes on with the station it was opened at. The
        certificates that are trusted stay the same.

        Args:
            url: The station.
            token: Operator or viewer token.
        """
        self._connection.talk_to(url.rstrip("/"), token)

    def close(self) -> None:
        """Close the connections."""
        self._connection.close()

    def health(self) -> wire.Health:
        """Return the boot_id of the process, which lives."""
        return self._connection.get("/health", wire.Health)

    def ready(self) -> wire.Ready:
        """Return when the loop runs with fresh cycles; an error says why not."""
        return self._connection.get("/ready", wire.Ready)

    def session(self) -> wire.Session:
        """Return which role the token has."""
        return self._connection.get("/session", wire.Session)

    def status(self) -> wire.Status:
        """Return the station at a glance."""
        return self._connection.get("/status", wire.Status)

    def hardware(self) -> wire.Hardware:
        """Return interfaces, claims, limits, transmissions and clamps of the robot."""
        return self._connection.get("/hardware", wire.Hardware)

    def controllers(self) -> list[wire.ControllerState]:
        """Return all loaded controllers."""
        found = self._connection.get("/controllers", wire.Controllers)
        return found.controllers

    def controller(self, name: str) -> wire.ControllerState:
        """Return one controller."""
        return self._connection.get(controller_path(name), wire.ControllerState)

    def load_controller(
        self,
        name: str,
        type: str | None = None,  # noqa: A002 - ros_control's word
        params: Mapping[str, JsonValue] | None = None,
        *,
        timeout: float | None = None,
        unknown_params: Literal["refuse", "tell"] | None = None,
        idempotency_key: str | None = None,
    ) -> wire.ControllerState:
        """Load a controller; loading the same one again changes nothing.

        Args:
            name: Its name.
            type: Its plugin type; None when the station's configuration has it.
            params: Its parameters; None when the station's configuration has them.
            timeout: How long its import, constructor and init may take [s]; None for
                the station's default.
            unknown_params: Whether parameters that its type does not know are refused,
                as when None, or told in its `notes`, as is right for files of ROS.
            idempotency_key: Random name of the request, 1 to 200 visible ASCII
                characters: sent again with the same key within 10 minutes, e.g. after a
                lost connection, it is carried out once.
        """
        request = load_request(name, type, params, timeout, unknown_params)
        return load(self._connection, request, idempotency_key)

    def unload_controller(
        self, name: str, *, idempotency_key: str | None = None
    ) -> wire.ControllerState:
        """Unload a stopped controller, or cancel its loading; return its last state.

        Args:
            name: Its name.
            idempotency_key: As for `load_controller`.
        """
        return unload(self._connection, name, idempotency_key)

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
        idempotency_key: str | None = None,
    ) -> wire.SwitchResult:
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
            idempotency_key: As for `load_controller`.
        """
        request = wire.SwitchRequest(
            start=list(start),
            stop=list(stop),
            strictness=strictness,
            start_asap=start_asap,
            timeout=timeout,
            bound=bound,
            dry_run=dry_run,
        )
        return switch(self._connection, request, idempotency_key)

    def gains(self, name: str) -> wire.Gains:
        """Return a controller's gains, their units and ranges, and their ETag."""
        return self._connection.get(controller_path(name, "gains"), wire.Gains)

    def set_gains(
        self, name: str, values: Mapping[str, float], etag: str | None = None
    ) -> wire.GainsChange:
        """Change gains in one cycle; the others keep their value.

        Args:
            name: The controller.
            values: New values by name, in the units of the schema.
            etag: Refuse when the gains are no longer those of that ETag.
        """
        path = controller_path(name, "gains")
        request = wire.GainsPatch(values=dict(values))
        headers = {} if etag is None else {"If-Match": etag}
        return self._connection.send(
            "PATCH", path, wire.GainsChange, request, headers=headers
        )

    def last_command(self, name: str) -> wire.CommandInfo:
        """Return the elements of a controller's set-point, and the last set-point."""
        path = controller_path(name, "command")
        return self._connection.get(path, wire.CommandInfo)

    def command(
        self,
        name: str,
        values: Sequence[float | None],
        epoch: int | None = None,
        timeout: float | None = None,
        rates: Sequence[float] | None = None,
    ) -> wire.CommandAccepted:
        """Send a set-point.

        Args:
            name: The controller.
            values: One number per element, in its order and units; None leaves an
                element at what the controller was told last.
            epoch: Refuse when a stop or reset came since that epoch.
            timeout: How long it is valid [s], 0 for ever; None for the controller's
                own setting.
            rates: How fast the set-point changes [rad/s or m/s], for controllers that
                feed this forward.
        """
        request = wire.CommandRequest(
            command=list(values),
            epoch=epoch,
            timeout=timeout,
            rates=None if rates is None else list(rates),
        )
        path = controller_path(name, "command")
        return self._connection.send("PUT", path, wire.CommandAccepted, request)

    def controller_state(self, name: str) -> wire.ControllerSample:
        """Return what a controller did in the last cycle."""
        path = controller_path(name, "state")
        return self._connection.get(path, wire.ControllerSample)

    def bench(
        self,
        name: str,
        excitation: Excitation,
        *,
        duration: float = 2.0,
        settling_band: float = 0.02,
    ) -> BenchResponse:
        """Excite one joint through a running controller, and return how it follows.

        The answer comes when the joint is back where it began. What is too large, too
        fast or too near a limit is refused before anything moves.

        Args:
            name: A running controller that takes set-points of joints.
            excitation: What the joint is asked to do, e.g. a
                `station.wire.excitations.Step` with the joint and an amplitude.
            duration: How long the response is measured [s], above 0, at most 10.
            settling_band: Half-width of the band of the settling time, as a share of
                the step, above 0 and below 1.
        """
        request = BenchRequest(
            excitation=excitation, duration=duration, settling_band=settling_band
        )
        path, patience = controller_path(name, "bench"), 5.0 * request.duration
        return self._connection.send(
            "POST", path, BenchResponse, request, patience=patience
        )

    def command_stream(self, controller: str, *, timeout: float = 0.2) -> CommandStream:
        """Return a stream of set-points for a `with` block (`async with`).

        Args:
            controller: The controller; it must run.
            timeout: Silence after which the last set-point expires [s], up to 60.
        """
        options = self._connection.command_options(controller, timeout)
        return CommandStream(options)

    def submit_goal(
        self, name: str, goal: Mapping[str, JsonValue], epoch: int | None = None
    ) -> wire.Goal:
        """Give a running controller a goal; it replaces the one before.

        Args:
            name: The controller.
            goal: The goal message of its action, times in seconds.
            epoch: Refuse when a stop or reset came since that epoch.
        """
        path = controller_path(name, "goals")
        request = wire.GoalRequest(goal=dict(goal), epoch=epoch)
        return self._connection.send("POST", path, wire.Goal, request)

    def goals(self, name: str) -> list[wire.Goal]:
        """Return a controller's latest goals, oldest first."""
        path = controller_path(name, "goals")
        return (self._connection.get(path, wire.Goals)).goals

    def goal(self, name: str, goal_id: str) -> wire.Goal:
        """Return a goal: its progress, or how and why it ended."""
        return self._connection.get(goal_path(name, goal_id), wire.Goal)

    def cancel_goal(self, name: str, goal_id: str) -> wire.Goal:
        """Cancel a goal; the joints hold from the next cycle on."""
        path = goal_path(name, goal_id)
        return self._connection.send("DELETE", path, wire.Goal)

    def follow_trajectory(
        self, name: str, trajectory: Mapping[str, JsonValue], epoch: int | None = None
    ) -> wire.CommandAccepted:
        """Let a running controller follow a trajectory without a goal.

        Args:
            name: The controller.
            trajectory: A JointTrajectory message, times in seconds; without points the
                joints stop and hold.
            epoch: Refuse when a stop or reset came since that epoch.
        """
        request = wire.TrajectoryRequest(trajectory=dict(trajectory), epoch=epoch)
        path = controller_path(name, "trajectory")
        return self._connection.send("POST", path, wire.CommandAccepted, request)

    def query_state(self, name: str, time: float | None = None) -> wire.DesiredState:
        """Return the desired joint state of a trajectory controller.

        Args:
            name: The controller.
            time: Station time [s]; now when None.
        """
        query = None if time is None else {"time": repr(time)}
        path = controller_path(name, "query_state")
        return self._connection.get(path, wire.DesiredState, query)

    def start_goal(
        self, name: str, goal: Mapping[str, JsonValue], epoch: int | None = None
    ) -> GoalHandle:
        """Give a controller a goal, as `submit_goal`, to wait for or to cancel.

        Args:
            name: The controller.
            goal: The goal message of its action, times in seconds.
            epoch: Refuse when a stop or reset came since that epoch.
        """
        answer = self.submit_goal(name, goal, epoch)
        return GoalHandle(self, name, answer)

    def start_move(
        self, target: Target, *, duration: float | None = None, controller: str = ""
    ) -> GoalHandle:
        """Begin to move joints, to wait for the end or to cancel.

        A trajectory controller does it. One is started if none runs, and controllers
        that hold the joints are stopped in the same cycle.

        Args:
            target: Name of a pose (`ready`, `stretched`), one position per joint of the
                controller, or positions by joint [rad or m]; other joints stay.
            duration: How long the motion takes [s]; a calm one when None.
            controller: The trajectory controller; found when empty.
        """
        return start_move(self, target, duration=duration, controller=controller)

    def move_to(
        self,
        target: Target | Pose,
        *,
        duration: float | None = None,
        timeout: float | None = None,
    ) -> None:
        """Move the arm and wait until it is there.

        Args:
            target: As for `start_move`; or a `Pose` of a Franka's end effector, which
                its Cartesian streaming controller moves along a straight line.
            duration: How long a motion of joints takes [s]; a calm one when None.
            timeout: Longest wait [s]; None waits for ever.

        Raises:
            MotionError: The arm did not arrive, and why.
            ValueError: A motion to a `Pose` was given a duration.
        """
        move_to(self, target, duration, timeout)

    def collect(
        self, seconds: float, topic: str = "joint_states", *, rate: Rate = "full"
    ) -> Samples:
        """Return what a topic streams for some seconds, as NumPy arrays.

        Args:
            seconds: How much station time, > 0 [s].
            topic: As for `stream`.
            rate: Samples per second [Hz], or "full" for every cycle of `joint_states`
                and `controller_state/<name>`.

        Raises:
            StreamTimeoutError: Nothing comes, e.g. because the simulation is paused.
        """
        return collect(self, seconds, topic, rate)

    def joint_states(self) -> wire.JointStates:
        """Return the joints of the last cycle."""
        return self._connection.get("/joint_states", wire.JointStates)

    def controller_types(self) -> list[wire.ControllerType]:
        """Return the types of controllers that can be loaded."""
        path = "/controller-types"
        return (self._connection.get(path, wire.ControllerTypes)).controller_types

    def reload_controller_types(self, *, force_kill: bool = False) -> list[str]:
        """Let the next load of each type read its Python module anew.

        Args:
            force_kill: Stop and unload all controllers first.

        Returns:
            Names of the controllers that were unloaded.
        """
        path = "/controller-types/reload"
        request = wire.ReloadRequest(force_kill=force_kill)
        answer = self._connection.send(
            "POST", path, wire.Reloaded, request, patience=SWITCH_BOUND
        )
        return answer.unloaded

    def parameter(self, path: str = "") -> JsonValue:
        """Return a parameter or a namespace; without a path the whole tree.

        Args:
            path: Names separated by `/`.
        """
        return (self._connection.get(_parameter(path), wire.Parameter)).value

    def set_parameter(self, path: str, value: JsonValue) -> None:
        """Set a parameter; controllers that are loaded afterwards read it.

        Args:
            path: Names separated by `/`.
            value: Any JSON; an object replaces the whole namespace.
        """
        request = wire.ParameterRequest(value=value)
        self._connection.send("PUT", _parameter(path), wire.Parameter, request)

    def delete_parameter(self, path: str) -> JsonValue:
        """Delete a parameter or a namespace; return what it was."""
        found = self._connection.send("DELETE", _parameter(path), wire.Parameter)
        return found.value

    def robots(self) -> list[wire.ArmReport]:
        """Return all arms with modes and errors, and what to do about the errors."""
        return (self._connection.get("/robots", wire.Arms)).robots

    def recover_all(self, restart: Restart = "none") -> wire.Recoveries:
        """Clear the errors of all arms; with `previous` start controllers again."""
        path, request = "/robots/error_recovery", wire.RecoveryRequest(restart=restart)
        return self._connection.send(
            "POST", path, wire.Recoveries, request, patience=5.0
        )

    def robot(self, arm_id: str = "panda") -> RobotClient:
        """Return the client of one arm."""
        return RobotClient(self._connection, arm_id)

    def scene(self) -> list[wire.SceneObject]:
        """Return the objects around a simulated robot, where they are now."""
        return (self._connection.get("/scene", wire.Scene)).objects

    def loop(self) -> wire.LoopReport:
        """Return state and statistics of the control loop."""
        return self._connection.get("/loop", wire.LoopReport)

    def reset_loop_statistics(self) -> wire.LoopReport:
        """Reset the loop's statistics."""
        path = "/loop/statistics/reset"
        return self._connection.send("POST", path, wire.LoopReport)

    def stop_state(self) -> wire.StopState:
        """Return the state of the latched stop."""
        return self._connection.get("/stop", wire.StopState)

    def stop(self, reason: str = "") -> wire.StopState:
        """Stop the robot; it stays stopped until released.

        Args:
            reason: For the record.
        """
        request = wire.StopRequest(reason=reason)
        return self._connection.send("POST", "/stop", wire.StopState, request)

    def release_stop(self, *, arm: bool = False) -> wire.StopState:
        """Release a stop, in two steps; nothing resumes by itself.

        Args:
            arm: False, first: the cause is gone. True, afterwards: allow motion again.
        """
        request = wire.ReleaseRequest(arm=arm)
        return self._connection.send("POST", "/stop/release", wire.StopState, request)

    def control(
        self, owner: str | None = None, *, ttl: float = 10.0, force: bool = False
    ) -> ControlLease:
        """Return control of the station for a `with` block (`async with`).

        While it lasts, the changes of other operators are refused; stopping is always
        possible.

        Args:
            owner: Name that others are told; that of the token when None.
            ttl: How long control lasts when this program falls silent [s], 0.5 to 3600.
            force: Take control from whoever holds it.
        """
        return ControlLease(self._connection, owner, ttl, force=force)

    def events(
        self,
        since: int | None = None,
        *,
        kinds: Sequence[wire.EventKindName] = (),
        severity: wire.SeverityName = "info",
        limit: int = 100,
    ) -> list[wire.Event]:
        """Return what happened at the station, oldest first.

        To follow events as they happen, iterate over `stream("events")`; the `data` of
        each frame is an event.

        Args:
            since: Number of the last event that is known; the newest events when None.
            kinds: Only events of these kinds; all when empty.
            severity: Only events of at least this severity.
            limit: Most events, 1 to 1000.
        """
        query = event_query(since, kinds, severity, limit)
        return (self._connection.get("/events", wire.Events, query)).events

    def stream_ticket(self) -> wire.StreamTicket:
        """Return a ticket that opens one WebSocket, e.g. for a browser."""
        return self._connection.send("POST", "/stream-tickets", wire.StreamTicket)

    def stream(
        self,
        topic: str,
        *,
        rate: Rate | None = None,
        fields: Sequence[str] = (),
        reconnect: bool = True,
    ) -> Stream:
        """Return a stream of a topic: iterate over it, or wait for a frame.

        `with` (`async with`) connects at once, within `timeout`, or raises.

        Args:
            topic: `joint_states`, `controllers`, `loop`, `events`,
                `controller_state/<name>`, `robot_state/<arm_id>`.
            rate: Frames per second [Hz], or "full" for every cycle, in batches.
            fields: Only these keys of `data`; all when empty.
            reconnect: Connect again when the link breaks, for ever.
        """
        options = self._connection.stream_options(
            topic, rate, fields, reconnect=reconnect
        )
        return Stream(options)


def _parameter(path: str) -> str:
    parts = [segment(part) for part in path.split("/") if part]
    return "/".join(["/parameters", *parts])
