"""The client for plain Python: it calls the asyncio client and waits for the end.

Requests need no event loop. Over a blocking connection a coroutine of the client never
suspends, and runs to its end in one step.
"""

import ssl
import threading
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine
from functools import wraps
from typing import Any, Concatenate, Generic, ParamSpec, Self, TypeVar, cast

import httpx
from typing_extensions import override

from station import wire
from station.client.blocking_streams import PORTAL, CommandStream, Stream
from station.client.connection import AsyncConnection
from station.client.controllers import AsyncGoalHandle
from station.client.errors import ApiError
from station.client.lease import AsyncControlLease, AsyncLeaseClient
from station.client.robots import (
    AsyncGripperClient,
    AsyncRobotClient,
    AsyncSimulationClient,
)
from station.client.station_client import AsyncStationClient
from station.client.stores import (
    AsyncAgentsClient,
    AsyncAlarmsClient,
    AsyncBenchRunsClient,
    AsyncCamerasClient,
    AsyncExperimentsClient,
    AsyncFilesClient,
    AsyncGainSetsClient,
    AsyncIncidentsClient,
    AsyncLessonsClient,
    AsyncPlotLayoutsClient,
    AsyncRecordingsClient,
    AsyncScenesClient,
    AsyncTokensClient,
    AsyncWaypointPathsClient,
)
from station.client.streams import certificates

P = ParamSpec("P")
R = TypeVar("R")
S = TypeVar("S")
FilesT = TypeVar("FilesT", bound=AsyncFilesClient)


def _run(coroutine: Coroutine[Any, Any, R]) -> R:
    """Run a coroutine that never suspends to its end.

    Raises:
        RuntimeError: The thread runs an event loop, which would wait for itself for
            ever.
    """
    try:
        # The coroutine never waits for an event loop, so it runs to its end in one
        # step.
        coroutine.send(None)
    except StopIteration as end:
        result: R = end.value
        return result
    coroutine.close()
    raise RuntimeError(f"{coroutine} waits for an event loop.")


def _made(
    method: Callable[Concatenate[Any, P], S], finish: Callable[[S], R]
) -> Callable[Concatenate[Any, P], R]:
    """Return a method that calls that of the asyncio client and converts its result."""

    @wraps(method)
    def call(self: "_Client[Any]", /, *args: P.args, **kwargs: P.kwargs) -> R:
        return finish(method(self._source, *args, **kwargs))

    return call


def _waited_for(
    method: Callable[Concatenate[Any, P], Coroutine[Any, Any, R]],
) -> Callable[Concatenate[Any, P], R]:
    """Return a method that runs that of the asyncio client to its end."""
    return _made(method, _run)


def _same(value: R) -> R:
    return value


class _Inline(httpx.AsyncBaseTransport):
    """An async transport over a blocking one, which never suspends."""

    def __init__(self, inner: httpx.BaseTransport) -> None:
        self._inner = inner

    @override
    async def handle_async_request(self, request: httpx.Request) -> httpx.Response:
        await request.aread()  # reads an uploaded file, too
        answer = self._inner.handle_request(request)
        # A blocking transport answers with a blocking stream.
        stream = cast("httpx.SyncByteStream", answer.stream)
        return httpx.Response(
            answer.status_code,
            headers=answer.headers,
            stream=_InlineStream(stream),
            extensions=answer.extensions,
        )

    @override
    async def aclose(self) -> None:
        self._inner.close()


class _InlineStream(httpx.AsyncByteStream):
    """The body of an answer, read without suspending."""

    def __init__(self, inner: httpx.SyncByteStream) -> None:
        self._inner = inner

    @override
    async def __aiter__(self) -> AsyncIterator[bytes]:
        for part in self._inner:
            yield part

    @override
    async def aclose(self) -> None:
        self._inner.close()


class _BlockingConnection(AsyncConnection):
    """A connection whose coroutines block instead of suspending."""

    def __init__(
        self,
        url: str,
        token: str | None,
        timeout: float,
        transport: httpx.AsyncBaseTransport | None,
        tls: ssl.SSLContext | None,
    ) -> None:
        if transport is None:
            # Ignore proxies of the environment: a stop must not depend on one.
            transport = _Inline(
                httpx.HTTPTransport(verify=certificates(tls), trust_env=False)
            )
        super().__init__(url, token, timeout, transport, tls)

    @override
    async def sleep(self, seconds: float) -> None:
        time.sleep(seconds)

    @override
    def repeat(
        self, act: Callable[[], Coroutine[Any, Any, bool]], period: float
    ) -> Callable[[], Awaitable[None]]:
        end = threading.Event()

        def run() -> None:
            while not end.wait(period) and _run(act()):
                pass

        thread = threading.Thread(target=run, name="heartbeat", daemon=True)
        thread.start()

        async def stop() -> None:
            end.set()
            thread.join()

        return stop


class _Source(AsyncStationClient):
    """The asyncio client behind a blocking one."""

    _connect = _BlockingConnection


class _Client(Generic[S]):
    """Common part of the blocking clients.

    Args:
        source: Object of the asyncio client whose methods this client calls.
    """

    def __init__(self, source: S) -> None:
        self._source = source


class SimulationClient(_Client[AsyncSimulationClient]):
    """The simulation of a station: `client.simulation`."""

    state = _waited_for(AsyncSimulationClient.state)
    bases = _waited_for(AsyncSimulationClient.bases)
    contacts = _waited_for(AsyncSimulationClient.contacts)
    pause = _waited_for(AsyncSimulationClient.pause)
    resume = _waited_for(AsyncSimulationClient.resume)
    set_real_time_factor = _waited_for(AsyncSimulationClient.set_real_time_factor)
    step = _waited_for(AsyncSimulationClient.step)
    reset = _waited_for(AsyncSimulationClient.reset)


class GripperClient(_Client[AsyncGripperClient]):
    """The gripper of an arm: `client.robot(arm_id).gripper`."""

    def __init__(self, source: AsyncGripperClient) -> None:
        super().__init__(source)
        self.arm_id = source.arm_id

    state = _waited_for(AsyncGripperClient.state)
    open = _waited_for(AsyncGripperClient.open)
    close = _waited_for(AsyncGripperClient.close)
    homing = _waited_for(AsyncGripperClient.homing)
    move = _waited_for(AsyncGripperClient.move)
    grasp = _waited_for(AsyncGripperClient.grasp)
    stop = _waited_for(AsyncGripperClient.stop)


class BenchRunsClient(_Client[AsyncBenchRunsClient]):
    """Runs of the bench that the station keeps: `client.bench_runs`."""

    list = _waited_for(AsyncBenchRunsClient.list)
    get = _waited_for(AsyncBenchRunsClient.get)
    delete = _waited_for(AsyncBenchRunsClient.delete)


class CamerasClient(_Client[AsyncCamerasClient]):
    """Cameras that look at the robots: `client.cameras`."""

    list = _waited_for(AsyncCamerasClient.list)
    save = _waited_for(AsyncCamerasClient.save)


class LessonsClient(_Client[AsyncLessonsClient]):
    """Exercises that the station checks on the student's own run: `client.lessons`."""

    list = _waited_for(AsyncLessonsClient.list)
    begin = _waited_for(AsyncLessonsClient.begin)
    check = _waited_for(AsyncLessonsClient.check)


class GainSetsClient(_Client[AsyncGainSetsClient]):
    """Named sets of gains on the station's disk: `client.gain_sets`."""

    names = _waited_for(AsyncGainSetsClient.names)
    get = _waited_for(AsyncGainSetsClient.get)
    save = _waited_for(AsyncGainSetsClient.save)
    delete = _waited_for(AsyncGainSetsClient.delete)
    apply = _waited_for(AsyncGainSetsClient.apply)
    set_gains = _waited_for(AsyncGainSetsClient.set_gains)
    undo = _waited_for(AsyncGainSetsClient.undo)


class FilesClient(_Client[FilesT]):
    """Common part of the clients of recordings and incidents."""

    list = _waited_for(AsyncFilesClient.list)
    get = _waited_for(AsyncFilesClient.get)
    trajectory = _waited_for(AsyncFilesClient.trajectory)
    bench = _waited_for(AsyncFilesClient.bench)
    download = _waited_for(AsyncFilesClient.download)
    download_table = _waited_for(AsyncFilesClient.download_table)
    events = _waited_for(AsyncFilesClient.events)
    add_note = _waited_for(AsyncFilesClient.add_note)


class RecordingsClient(FilesClient[AsyncRecordingsClient]):
    """Recordings of every cycle on the station's disk: `client.recordings`."""

    start = _waited_for(AsyncRecordingsClient.start)
    upload = _waited_for(AsyncRecordingsClient.upload)
    stop = _waited_for(AsyncRecordingsClient.stop)
    delete = _waited_for(AsyncRecordingsClient.delete)


class IncidentsClient(FilesClient[AsyncIncidentsClient]):
    """Recordings around stops, reflexes and faults: `client.incidents`."""


class ExperimentsClient(_Client[AsyncExperimentsClient]):
    """Experiments that run beside the station: `client.experiments`."""

    start = _waited_for(AsyncExperimentsClient.start)
    get = _waited_for(AsyncExperimentsClient.get)
    wait = _waited_for(AsyncExperimentsClient.wait)
    cancel = _waited_for(AsyncExperimentsClient.cancel)
    delete = _waited_for(AsyncExperimentsClient.delete)
    trials = _waited_for(AsyncExperimentsClient.trials)
    best = _waited_for(AsyncExperimentsClient.best)
    responses = _waited_for(AsyncExperimentsClient.responses)
    preview = _waited_for(AsyncExperimentsClient.preview)
    apply = _waited_for(AsyncExperimentsClient.apply)
    list = _waited_for(AsyncExperimentsClient.list)


class ScenesClient(_Client[AsyncScenesClient]):
    """Named scenes on the station's disk: `client.scenes`."""

    names = _waited_for(AsyncScenesClient.names)
    get = _waited_for(AsyncScenesClient.get)
    save = _waited_for(AsyncScenesClient.save)
    load = _waited_for(AsyncScenesClient.load)
    delete = _waited_for(AsyncScenesClient.delete)


class PlotLayoutsClient(_Client[AsyncPlotLayoutsClient]):
    """Named layouts of plots on the station's disk: `client.plot_layouts`."""

    names = _waited_for(AsyncPlotLayoutsClient.names)
    get = _waited_for(AsyncPlotLayoutsClient.get)
    save = _waited_for(AsyncPlotLayoutsClient.save)
    delete = _waited_for(AsyncPlotLayoutsClient.delete)


class WaypointPathsClient(_Client[AsyncWaypointPathsClient]):
    """Waypoint paths on the disk, and their playing: `client.waypoint_paths`."""

    names = _waited_for(AsyncWaypointPathsClient.names)
    get = _waited_for(AsyncWaypointPathsClient.get)
    save = _waited_for(AsyncWaypointPathsClient.save)
    delete = _waited_for(AsyncWaypointPathsClient.delete)
    capture = _waited_for(AsyncWaypointPathsClient.capture)
    play = _waited_for(AsyncWaypointPathsClient.play)
    playback = _waited_for(AsyncWaypointPathsClient.playback)
    change = _waited_for(AsyncWaypointPathsClient.change)
    cancel = _waited_for(AsyncWaypointPathsClient.cancel)


class AlarmsClient(_Client[AsyncAlarmsClient]):
    """Alarms, each of which needs a person: `client.alarms`."""

    list = _waited_for(AsyncAlarmsClient.list)
    acknowledge = _waited_for(AsyncAlarmsClient.acknowledge)


class TokensClient(_Client[AsyncTokensClient]):
    """Named tokens that an operator makes, lists and revokes: `client.tokens`."""

    list = _waited_for(AsyncTokensClient.list)
    create = _waited_for(AsyncTokensClient.create)
    revoke = _waited_for(AsyncTokensClient.revoke)


class AgentsClient(_Client[AsyncAgentsClient]):
    """Requests of agents, which a person allows or refuses: `client.agents`."""

    requests = _waited_for(AsyncAgentsClient.requests)
    answer = _waited_for(AsyncAgentsClient.answer)


class LeaseClient(_Client[AsyncLeaseClient]):
    """Control of the station, taken and given back call by call: `client.lease`."""

    act_under = _made(AsyncLeaseClient.act_under, _same)
    take = _waited_for(AsyncLeaseClient.take)
    renew = _waited_for(AsyncLeaseClient.renew)
    release = _waited_for(AsyncLeaseClient.release)
    state = _waited_for(AsyncLeaseClient.state)


class GoalHandle(_Client[AsyncGoalHandle]):
    """A goal of a controller: `station.start_goal(…)`, `station.start_move(…)`."""

    @property
    def controller(self) -> str:
        """The controller that has the goal."""
        return self._source.controller

    @property
    def latest(self) -> wire.Goal:
        """State of the goal when it was last read."""
        return self._source.latest

    @property
    def is_final(self) -> bool:
        """True if the goal had ended when it was last read."""
        return self._source.is_final

    refresh = _waited_for(AsyncGoalHandle.refresh)
    cancel = _waited_for(AsyncGoalHandle.cancel)
    ended = _waited_for(AsyncGoalHandle.ended)
    wait = _waited_for(AsyncGoalHandle.wait)


class ControlLease(_Client[AsyncControlLease]):
    """Control of the station for the duration of a `with` block."""

    @property
    def lost(self) -> ApiError | None:
        """Return the reason for the loss of control, see `AsyncControlLease`."""
        return self._source.lost

    def __enter__(self) -> Self:
        """Take control.

        Raises:
            ApiError: Another client holds control.
            StationUnreachableError: The station does not answer.
        """
        _run(self._source.__aenter__())
        return self

    def __exit__(self, *_: object) -> None:
        _run(self._source.__aexit__())

    renew = _waited_for(AsyncControlLease.renew)
    hand_over = _waited_for(AsyncControlLease.hand_over)


class RobotClient(_Client[AsyncRobotClient]):
    """One arm of a station: `client.robot(arm_id)`."""

    def __init__(self, source: AsyncRobotClient) -> None:
        super().__init__(source)
        self.arm_id = source.arm_id
        self.gripper = GripperClient(source.gripper)

    state = _waited_for(AsyncRobotClient.state)
    model = _waited_for(AsyncRobotClient.model)
    errors = _waited_for(AsyncRobotClient.errors)
    log = _waited_for(AsyncRobotClient.log)
    recover = _waited_for(AsyncRobotClient.recover)
    services = _waited_for(AsyncRobotClient.services)
    call = _waited_for(AsyncRobotClient.call)
    user_stop = _waited_for(AsyncRobotClient.user_stop)
    guiding = _waited_for(AsyncRobotClient.guiding)
    connect = _waited_for(AsyncRobotClient.connect)
    disconnect = _waited_for(AsyncRobotClient.disconnect)
    set_joint_impedance = _waited_for(AsyncRobotClient.set_joint_impedance)
    set_cartesian_impedance = _waited_for(AsyncRobotClient.set_cartesian_impedance)
    # Names of libfranka.
    set_EE_frame = _waited_for(AsyncRobotClient.set_EE_frame)  # noqa: N815
    set_K_frame = _waited_for(AsyncRobotClient.set_K_frame)  # noqa: N815
    set_load = _waited_for(AsyncRobotClient.set_load)
    set_force_torque_collision_behavior = _waited_for(
        AsyncRobotClient.set_force_torque_collision_behavior
    )
    set_full_collision_behavior = _waited_for(
        AsyncRobotClient.set_full_collision_behavior
    )
    apply_force = _waited_for(AsyncRobotClient.apply_force)
    inject = _waited_for(AsyncRobotClient.inject)
    faults = _waited_for(AsyncRobotClient.faults)
    clear_faults = _waited_for(AsyncRobotClient.clear_faults)


def _goal_handle(begun: Coroutine[Any, Any, AsyncGoalHandle]) -> GoalHandle:
    return GoalHandle(_run(begun))


class StationClient(_Client[AsyncStationClient]):
    """Talks to a station.

    Its methods are those of `AsyncStationClient`, which describes its parts and the
    errors that they raise. Here they return when the answer has come. Any thread may
    call them.

    Args:
        url: URL of the station, as for `AsyncStationClient`; None finds the one on this
            machine.
        token: Operator or viewer token.
        timeout: Longest wait for an answer [s].
        transport: Transport of requests, for tests; None for httpx's own.
        ca: PEM file with the certificates to trust with an https `url`.

    Raises:
        NoStationError: No `url`, and no station or several on this machine.
        TlsFilesError: The certificates to trust cannot be read.
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
        inline = None if transport is None else _Inline(transport)
        source = _Source(url, token, timeout=timeout, transport=inline, ca=ca)
        super().__init__(source)
        self.simulation = SimulationClient(source.simulation)
        self.bench_runs = BenchRunsClient(source.bench_runs)
        self.lessons = LessonsClient(source.lessons)
        self.cameras = CamerasClient(source.cameras)
        self.gain_sets = GainSetsClient(source.gain_sets)
        self.recordings = RecordingsClient(source.recordings)
        self.incidents = IncidentsClient(source.incidents)
        self.experiments = ExperimentsClient(source.experiments)
        self.plot_layouts = PlotLayoutsClient(source.plot_layouts)
        self.scenes = ScenesClient(source.scenes)
        self.waypoint_paths = WaypointPathsClient(source.waypoint_paths)
        self.alarms = AlarmsClient(source.alarms)
        self.tokens = TokensClient(source.tokens)
        self.agents = AgentsClient(source.agents)
        self.lease = LeaseClient(source.lease)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    _repr_html_ = _made(AsyncStationClient._repr_html_, _same)

    @property
    def url(self) -> str:
        """URL of the station."""
        return self._source.url

    @property
    def timeout(self) -> float:
        """Longest wait for an answer [s]."""
        return self._source.timeout

    @timeout.setter
    def timeout(self, timeout: float) -> None:
        self._source.timeout = timeout

    @property
    def tls(self) -> ssl.SSLContext | None:
        """TLS context that checks the station's certificate; None for HTTP."""
        return self._source.tls

    begin_within = _made(AsyncStationClient.begin_within, _same)
    talk_to = _made(AsyncStationClient.talk_to, _same)
    close = _waited_for(AsyncStationClient.close)
    health = _waited_for(AsyncStationClient.health)
    ready = _waited_for(AsyncStationClient.ready)
    session = _waited_for(AsyncStationClient.session)
    status = _waited_for(AsyncStationClient.status)
    hardware = _waited_for(AsyncStationClient.hardware)
    hardware_components = _waited_for(AsyncStationClient.hardware_components)
    set_hardware_component_state = _waited_for(
        AsyncStationClient.set_hardware_component_state
    )
    controllers = _waited_for(AsyncStationClient.controllers)
    controller = _waited_for(AsyncStationClient.controller)
    chains = _waited_for(AsyncStationClient.chains)
    load_controller = _waited_for(AsyncStationClient.load_controller)
    unload_controller = _waited_for(AsyncStationClient.unload_controller)
    switch_controllers = _waited_for(AsyncStationClient.switch_controllers)
    gains = _waited_for(AsyncStationClient.gains)
    set_gains = _waited_for(AsyncStationClient.set_gains)
    download_config = _waited_for(AsyncStationClient.download_config)
    last_command = _waited_for(AsyncStationClient.last_command)
    command = _waited_for(AsyncStationClient.command)
    controller_state = _waited_for(AsyncStationClient.controller_state)
    bench = _waited_for(AsyncStationClient.bench)
    command_stream = _made(AsyncStationClient.command_stream, CommandStream)
    submit_goal = _waited_for(AsyncStationClient.submit_goal)
    rehearse = _waited_for(AsyncStationClient.rehearse)
    plan = _waited_for(AsyncStationClient.plan)
    goals = _waited_for(AsyncStationClient.goals)
    goal = _waited_for(AsyncStationClient.goal)
    cancel_goal = _waited_for(AsyncStationClient.cancel_goal)
    follow_trajectory = _waited_for(AsyncStationClient.follow_trajectory)
    query_state = _waited_for(AsyncStationClient.query_state)
    start_goal = _made(AsyncStationClient.start_goal, _goal_handle)
    start_motion_sequence = _made(
        AsyncStationClient.start_motion_sequence, _goal_handle
    )
    start_move = _made(AsyncStationClient.start_move, _goal_handle)
    move_to = _waited_for(AsyncStationClient.move_to)
    collect = _made(AsyncStationClient.collect, PORTAL.run_alone)
    joint_states = _waited_for(AsyncStationClient.joint_states)
    controller_types = _waited_for(AsyncStationClient.controller_types)
    reload_controller_types = _waited_for(AsyncStationClient.reload_controller_types)
    parameter = _waited_for(AsyncStationClient.parameter)
    set_parameter = _waited_for(AsyncStationClient.set_parameter)
    delete_parameter = _waited_for(AsyncStationClient.delete_parameter)
    robots = _waited_for(AsyncStationClient.robots)
    recover_all = _waited_for(AsyncStationClient.recover_all)
    robot = _made(AsyncStationClient.robot, RobotClient)
    scene = _waited_for(AsyncStationClient.scene)
    clearances = _waited_for(AsyncStationClient.clearances)
    attach_object = _waited_for(AsyncStationClient.attach_object)
    detach_object = _waited_for(AsyncStationClient.detach_object)
    put_object = _waited_for(AsyncStationClient.put_object)
    remove_object = _waited_for(AsyncStationClient.remove_object)
    loop = _waited_for(AsyncStationClient.loop)
    reset_loop_statistics = _waited_for(AsyncStationClient.reset_loop_statistics)
    stop_state = _waited_for(AsyncStationClient.stop_state)
    stop = _waited_for(AsyncStationClient.stop)
    release_stop = _waited_for(AsyncStationClient.release_stop)
    control = _made(AsyncStationClient.control, ControlLease)
    events = _waited_for(AsyncStationClient.events)
    stream_ticket = _waited_for(AsyncStationClient.stream_ticket)
    stream = _made(AsyncStationClient.stream, Stream)
