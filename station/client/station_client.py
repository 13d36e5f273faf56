"""The client of a station: one method per route."""

import ssl
from collections.abc import Sequence
from html import escape
from typing import Self, TypeVar

import httpx
from pydantic import JsonValue, ValidationError

from station import wire
from station.client.connection import AsyncConnection, Query, RequestDeadline, segment
from station.client.controllers import AsyncControllersClient, AsyncGoalHandle
from station.client.lease import AsyncControlLease, AsyncLeaseClient
from station.client.motion import move_to, start_move
from station.client.poses import Pose, Target
from station.client.robots import AsyncRobotClient, AsyncSimulationClient, Restart
from station.client.samples import Samples
from station.client.stores import (
    AsyncAgentsClient,
    AsyncAlarmsClient,
    AsyncBenchRunsClient,
    AsyncCamerasClient,
    AsyncExperimentsClient,
    AsyncGainSetsClient,
    AsyncIncidentsClient,
    AsyncLessonsClient,
    AsyncPlotLayoutsClient,
    AsyncRecordingsClient,
    AsyncScenesClient,
    AsyncTokensClient,
    AsyncWaypointPathsClient,
)
from station.client.streams import (
    AsyncCommandStream,
    AsyncStream,
    Rate,
    bearer,
    certificates,
)
from station.local.station_locator import locate
from station.local.tls import trust
from station.wire import Controllers, JointStates, Status
from station.wire.base import reader_of
from station.wire.protocol import PREFIX
from station.wire.robots import ComponentStateName

ModelT = TypeVar("ModelT")

_SUMMARY_TIMEOUT = 1.0
"""Longest wait for the station [s]; a cell of a notebook must not hang."""


class AsyncStationClient(AsyncControllersClient):
    """Talks to a station.

    The methods of `StationClient` block until the answer has come; those of
    `AsyncStationClient` are awaited.

    Every method raises `ApiError` when the station refuses, and its subclass
    `StationUnreachableError` when the station does not answer. Arguments that cannot be
    sent at all (NaN, a string for a number) raise pydantic's `ValidationError`, a
    `ValueError`, before anything is sent.

    Proxies and other settings of the environment are not used, because a station is
    near and its token must not travel through a proxy.

    Args:
        url: URL of the station, e.g. `http://127.0.0.1:8000`. None takes `STATION_URL`,
            or else the only running station of this user on this machine.
        token: Operator or viewer token. None takes `STATION_TOKEN`, or else the token
            of a station on this machine; without a token only `health` and `ready`
            work.
        timeout: Longest wait for an answer [s].
        transport: Transport of requests, for tests; None for httpx's own.
        ca: PEM file with the certificates to trust with an https `url`. None takes
            `STATION_CA`, or else the certificate of the station on this machine, or
            else the system's certificates.

    Raises:
        NoStationError: No `url`, and no station or several on this machine.
        TlsFilesError: The certificates to trust cannot be read.

    Attributes:
        simulation: Pause, step and reset of a simulated robot.
        bench_runs: Runs of the bench that the station keeps.
        lessons: Exercises that the station checks on the student's own run.
        cameras: Cameras that look at the robots, and their pictures.
        gain_sets: Named sets of gains on the station's disk.
        plot_layouts: Named layouts of plots on the station's disk.
        scenes: Named scenes on the station's disk.
        waypoint_paths: Waypoint paths on the station's disk, and their playing.
        tokens: Named tokens of people and programs.
        agents: Requests of agents, and a person's answers.
        alarms: Alarms, and their acknowledgements.
        lease: Control, taken and given back call by call; see also `control`.
        recordings: Recordings of every cycle on the station's disk.
        incidents: Cycles kept around stops, reflexes and faults.
        experiments: Many trials of a simulated copy of the station.
    """

    _connect: type[AsyncConnection] = AsyncConnection

    def __init__(
        self,
        url: str | None = None,
        token: str | None = None,
        *,
        timeout: float = 10.0,
        transport: httpx.AsyncBaseTransport | None = None,
        ca: str | None = None,
    ) -> None:
        url, token = locate(url, token)
        connection = self._connect(
            url.rstrip("/"), token, timeout, transport, trust(url, ca)
        )
        super().__init__(connection)
        self.simulation = AsyncSimulationClient(connection)
        self.bench_runs = AsyncBenchRunsClient(connection)
        self.lessons = AsyncLessonsClient(connection)
        self.cameras = AsyncCamerasClient(connection)
        self.gain_sets = AsyncGainSetsClient(connection)
        self.recordings = AsyncRecordingsClient(connection)
        self.incidents = AsyncIncidentsClient(connection)
        self.experiments = AsyncExperimentsClient(connection)
        self.plot_layouts = AsyncPlotLayoutsClient(connection)
        self.scenes = AsyncScenesClient(connection)
        self.waypoint_paths = AsyncWaypointPathsClient(connection)
        self.alarms = AsyncAlarmsClient(connection)
        self.tokens = AsyncTokensClient(connection)
        self.agents = AsyncAgentsClient(connection)
        self.lease = AsyncLeaseClient(connection)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    def _repr_html_(self) -> str:
        """Return the summary of the station that a notebook shows."""
        return summary_html(self.url, self._connection.token, tls=self._connection.tls)

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

    def begin_within(self, deadline: RequestDeadline | None) -> None:
        """Make the station refuse changes that would begin too late.

        Args:
            deadline: Computes the latest begin, from the next request on; several
                clients of one station may share it. None lets a change begin however
                late it comes.
        """
        self._connection.deadline = deadline

    @property
    def tls(self) -> ssl.SSLContext | None:
        """TLS context that checks the station's certificate; None for HTTP."""
        return self._connection.tls

    def talk_to(self, url: str, token: str | None) -> None:
        """Talk to another station from the next request on.

        An open stream stays with its station. The trusted certificates stay the same.

        Args:
            url: The station.
            token: Operator or viewer token.
        """
        self._connection.talk_to(url.rstrip("/"), token)

    async def close(self) -> None:
        """Close the connections."""
        await self._connection.close()

    async def health(self) -> wire.Health:
        """Return the boot_id of the process, which shows that it runs."""
        return await self._get("/health", wire.Health)

    async def ready(self) -> wire.Ready:
        """Check that the loop runs with fresh cycles; otherwise raise the reason."""
        return await self._get("/ready", wire.Ready)

    async def session(self) -> wire.Session:
        """Return the role of the token."""
        return await self._get("/session", wire.Session)

    async def status(self) -> wire.Status:
        """Return the station at a glance."""
        return await self._get("/status", wire.Status)

    async def hardware(self) -> wire.Hardware:
        """Return interfaces, claims, limits, transmissions and clamps of the robot."""
        return await self._get("/hardware", wire.Hardware)

    async def hardware_components(self) -> list[wire.HardwareComponentReport]:
        """Return the hardware components with their states and interfaces."""
        path = "/hardware/components"
        found = await self._connection.get(path, wire.HardwareComponents)
        return found.components

    async def set_hardware_component_state(
        self, name: str, state: ComponentStateName, *, stop_controllers: bool = False
    ) -> wire.HardwareComponentReport:
        """Bring a hardware component into a state of its life cycle.

        Args:
            name: The component.
            state: `unconfigured`, `inactive`, `active` or `finalized`.
            stop_controllers: Whether to stop the controllers that command it first;
                otherwise the station refuses while a controller commands it.
        """
        return await self._connection.send(
            "PUT",
            f"/hardware/components/{segment(name)}/state",
            wire.HardwareComponentReport,
            wire.HardwareComponentStateRequest(
                state=state, stop_controllers=stop_controllers
            ),
        )

    def command_stream(
        self, controller: str, *, timeout: float = 0.2
    ) -> AsyncCommandStream:
        """Return a stream of set-points for a `with` block (`async with`).

        Args:
            controller: The controller; it must run.
            timeout: Silence after which the last set-point expires [s], up to 60.
        """
        return AsyncCommandStream(self._connection.command_options(controller, timeout))

    async def start_move(
        self,
        target: Target | Pose,
        *,
        duration: float | None = None,
        controller: str = "",
        plan: bool = False,
        certificate: str | None = None,
    ) -> AsyncGoalHandle:
        """Begin to move joints, and return a handle to wait for the end or to cancel.

        A trajectory controller moves the joints. If none runs, one is started, and
        controllers that claim the joints are stopped in the same cycle.

        Args:
            target: Name of a pose (`ready`, `stretched`), one position per joint of the
                controller, or positions by joint [rad or m]; other joints stay. With
                `plan` also a `Pose`, or the name of a pose of the robot.
            duration: Duration of the motion [s]; None for a slow motion.
            controller: The trajectory controller; empty finds one.
            plan: Whether to plan a path without collisions; it has its own duration.
            certificate: Certificate of a rehearsal of this motion; None without one.
        """
        return await start_move(
            self,
            target,
            duration=duration,
            controller=controller,
            plan=plan,
            certificate=certificate,
        )

    async def move_to(
        self,
        target: Target | Pose,
        *,
        duration: float | None = None,
        timeout: float | None = None,
        plan: bool = False,
    ) -> None:
        """Move the arm and wait until it has arrived.

        Args:
            target: As for `start_move`; or a `Pose` of a Franka's end effector, which
                its Cartesian streaming controller moves along a straight line.
            duration: Duration of a motion of joints [s]; None for a slow motion.
            timeout: Longest wait [s]; None waits for ever.
            plan: Whether to plan a path of the joints without collisions, as in
                `start_move`.

        Raises:
            MotionError: The arm did not arrive; the message has the reason.
            ValueError: A motion to a `Pose` was given a duration.
        """
        sleep = self._connection.sleep
        await move_to(self, target, duration, timeout, sleep, plan=plan)

    async def collect(
        self, seconds: float, topic: str = "joint_states", *, rate: Rate = "full"
    ) -> Samples:
        """Collect the samples of a topic for some seconds, as NumPy arrays.

        Args:
            seconds: Station time to collect [s], > 0.
            topic: As for `stream`.
            rate: Samples per second [Hz], or "full" for every cycle of `joint_states`
                and `controller_state/<name>`.

        Raises:
            StreamTimeoutError: No sample comes, e.g. because the simulation is paused.
        """
        stream = self.stream(topic, rate=rate, reconnect=False)
        return await stream.collect(seconds, self.timeout)

    async def joint_states(self) -> wire.JointStates:
        """Return the joint states of the last cycle."""
        return await self._get("/joint_states", wire.JointStates)

    async def parameter(self, path: str = "") -> JsonValue:
        """Return a parameter or a namespace; without a path the whole tree.

        Args:
            path: Names separated by `/`.
        """
        return (await self._get(_parameter(path), wire.Parameter)).value

    async def set_parameter(self, path: str, value: JsonValue) -> None:
        """Set a parameter, which controllers that are loaded afterwards read.

        Args:
            path: Names separated by `/`.
            value: Any JSON; an object replaces the whole namespace.
        """
        request = wire.ParameterRequest(value=value)
        await self._send("PUT", _parameter(path), wire.Parameter, request)

    async def delete_parameter(self, path: str) -> JsonValue:
        """Delete a parameter or a namespace; return its last value."""
        return (await self._send("DELETE", _parameter(path), wire.Parameter)).value

    async def robots(self) -> list[wire.ArmReport]:
        """Return all arms with modes, errors and remedies."""
        return (await self._get("/robots", wire.Arms)).robots

    async def recover_all(self, restart: Restart = "none") -> wire.Recoveries:
        """Clear the errors of all arms; with `previous` restart stopped controllers."""
        path, request = "/robots/error_recovery", wire.RecoveryRequest(restart=restart)
        return await self._send("POST", path, wire.Recoveries, request, patience=5.0)

    def robot(self, arm_id: str = "panda") -> AsyncRobotClient:
        """Return the client of one arm."""
        return AsyncRobotClient(self._connection, arm_id)

    async def scene(self) -> list[wire.SceneObject]:
        """Return the objects around a simulated robot at their present poses."""
        return (await self._get("/scene", wire.Scene)).objects

    async def clearances(self) -> list[wire.Clearance]:
        """Return the nearest pair of each arm that keeps clear of objects."""
        return (await self._get("/scene", wire.Scene)).clearances

    async def put_object(self, name: str, /, **values: JsonValue) -> wire.SceneObject:
        """Add an object that arms keep clear of, or change the object of that name.

        Args:
            name: Its name.
            values: Fields of `SceneObjectRequest`, e.g. `type`, `size`, `position` [m],
                `role`, `margin` [m].
        """
        request = wire.SceneObjectRequest.model_validate(values)
        path = f"/scene/{segment(name)}"
        return await self._send("PUT", path, wire.SceneObject, request)

    async def remove_object(self, name: str) -> list[wire.SceneObject]:
        """Remove an object with a role; return the remaining ones."""
        path = f"/scene/{segment(name)}"
        return (await self._send("DELETE", path, wire.Scene)).objects

    async def attach_object(
        self, name: str, arm: str = "", *, load: bool = True
    ) -> wire.SceneObject:
        """Let an arm carry an object, which moves with its hand from now on.

        Args:
            name: The object.
            arm: The arm; may be empty if there is only one.
            load: Whether to set the load of the arm, too, which must not move.
        """
        request = wire.AttachRequest(arm=arm, load=load)
        path = f"/scene/{segment(name)}/attach"
        return await self._connection.send("POST", path, wire.SceneObject, request)

    async def detach_object(self, name: str, *, load: bool = True) -> wire.SceneObject:
        """Let an arm put a carried object down where it is.

        Args:
            name: The object.
            load: Whether to set the load of the arm to the objects that it still
                carries; the arm must not move.
        """
        request = wire.DetachRequest(load=load)
        path = f"/scene/{segment(name)}/detach"
        return await self._connection.send("POST", path, wire.SceneObject, request)

    async def loop(self) -> wire.LoopStatistics:
        """Return state and statistics of the control loop."""
        return await self._get("/loop", wire.LoopStatistics)

    async def reset_loop_statistics(self) -> wire.LoopStatistics:
        """Reset the statistics of the loop and of the controllers."""
        return await self._send("POST", "/loop/statistics/reset", wire.LoopStatistics)

    async def stop_state(self) -> wire.StopState:
        """Return the state of the latched stop."""
        return await self._get("/stop", wire.StopState)

    async def stop(self, reason: str = "") -> wire.StopState:
        """Stop the robot; it stays stopped until released.

        Args:
            reason: Reason, which the station records.
        """
        request = wire.StopRequest(reason=reason)
        return await self._send("POST", "/stop", wire.StopState, request)

    async def release_stop(self, *, arm: bool = False) -> wire.StopState:
        """Release a stop, in two steps; nothing resumes by itself.

        Args:
            arm: False, first: the cause is gone. True, afterwards: allow motion again.
        """
        request = wire.ReleaseRequest(arm=arm)
        return await self._send("POST", "/stop/release", wire.StopState, request)

    def control(
        self, owner: str | None = None, *, ttl: float = 10.0, force: bool = False
    ) -> AsyncControlLease:
        """Return the control of the station, to hold in a `with` block (`async with`).

        While the block lasts, the station refuses changes by other operators; every
        client can always stop the robot.

        Args:
            owner: Name that others see; None for the name of the token.
            ttl: How long control lasts without a heartbeat [s], 0.5 to 3600.
            force: Whether to take control from its present holder.
        """
        return AsyncControlLease(self._connection, owner, ttl, force=force)

    async def events(
        self,
        since: int | None = None,
        *,
        kinds: Sequence[wire.EventKindName] = (),
        severity: wire.SeverityName = "info",
        limit: int = 100,
    ) -> list[wire.Event]:
        """Return the events of the station, oldest first.

        To follow events as they happen, iterate over `stream("events")`; the `data` of
        each frame is an event.

        Args:
            since: Number of the last event that the caller knows; None returns the
                newest events.
            kinds: Only events of these kinds; all when empty.
            severity: Only events of at least this severity.
            limit: Most events, 1 to 1000.
        """
        query: Query = {
            "severity": severity,
            "limit": str(limit),
            "kind": list(kinds),
            **({} if since is None else {"since": str(since)}),
        }
        return (await self._get("/events", wire.Events, query)).events

    async def stream_ticket(self) -> wire.StreamTicket:
        """Return a ticket that opens one WebSocket, e.g. for a browser."""
        return await self._send("POST", "/stream-tickets", wire.StreamTicket)

    def stream(
        self,
        topic: str,
        *,
        rate: Rate | None = None,
        fields: Sequence[str] = (),
        reconnect: bool = True,
    ) -> AsyncStream:
        """Return a stream of a topic, to iterate over or to wait for a frame.

        `with` (`async with`) connects at once, within `timeout`, or raises an error.

        Args:
            topic: `joint_states`, `controllers`, `loop`, `events`,
                `controller_state/<name>`, `robot_state/<arm_id>`.
            rate: Frames per second [Hz], or "full" for every cycle, in batches.
            fields: Keys of `data` to send; all when empty.
            reconnect: Whether to connect again, for ever, when the link breaks.
        """
        options = self._connection.stream_options(
            topic, rate, fields, reconnect=reconnect
        )
        return AsyncStream(options)


def _parameter(path: str) -> str:
    parts = [segment(part) for part in path.split("/") if part]
    return "/".join(["/parameters", *parts])


def summary_html(
    url: str,
    token: str | None,
    transport: httpx.BaseTransport | None = None,
    tls: ssl.SSLContext | None = None,
) -> str:
    """Return HTML of the station, its running controllers and its joints.

    Args:
        url: URL of the station.
        token: Operator or viewer token.
        transport: Transport of requests; None for httpx's own.
        tls: TLS context that checks the station's certificate; None for plain HTTP.
    """
    title = f"<b>Station</b> <a href='{escape(url)}/docs'>{escape(url)}</a>"
    try:
        with httpx.Client(
            base_url=url + PREFIX,
            headers=bearer(token),
            timeout=_SUMMARY_TIMEOUT,
            transport=transport,
            trust_env=False,
            verify=certificates(tls),
        ) as http:
            status = _ask(http, "/status", Status)
            controllers = _ask(http, "/controllers", Controllers)
            joints = _ask(http, "/joint_states", JointStates)
    except (httpx.HTTPError, ValidationError) as error:
        return f"{title}: no answer ({escape(str(error))})"
    running = [c.name for c in controllers.controllers if c.state == "running"]
    facts = f"{status.robot_mode}, stop {status.stop_state}, epoch {status.epoch}"
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{_number(q)}</td><td>{_number(dq)}</td></tr>"
        for name, q, dq in zip(
            joints.name, joints.position, joints.velocity, strict=False
        )
    )
    names = escape(", ".join(running) or "nothing")
    return (
        f"{title}: {escape(facts)}<br>running: {names}"
        "<table><tr><th>joint</th><th>position</th><th>velocity</th></tr>"
        f"{rows}</table>"
    )


def _ask(http: httpx.Client, path: str, model: type[ModelT]) -> ModelT:
    return reader_of(model).validate_json(http.get(path).raise_for_status().content)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"
