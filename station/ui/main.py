"""Run the dashboard as a process of its own, until a signal or its station's end."""

import asyncio
import contextlib
import gc
import logging
import signal
import socket
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import uvicorn
from starlette.applications import Starlette
from typing_extensions import override

from station.client import ApiError, AsyncStationClient
from station.ui.dashboard import Dashboard
from station.ui.gateway.api_relay import ApiRelay
from station.ui.gateway.gateway import GatewayParts, StopButton, build_gateway
from station.ui.gateway.guard import origin_policy
from station.ui.gateway.viser_relay import ViserRelay, open_viser
from station.ui.link.station_access import StationAccess, StationFollower
from station.ui.page.workspace_routes import WorkspaceParts
from station.ui.scene.robot_model import RobotModel, RobotModelError, load_robot
from station.ui.sessions.session_access import SessionAccess, SessionPusher
from station.ui.sessions.sessions import BrowserSession, Role, Sessions, SessionStore
from station.web.limited_server import (
    LimitedServer,
    SocketProtocol,
    connection_share,
)
from station.wire import StopState

_logger = logging.getLogger(__name__)
_LOOK_PERIOD = 0.05
_CLOSING_TIME = 1
_DESCRIPTORS = 3
"""File descriptors per 3D view: its socket, and both ends of the socket to Viser."""
_REQUEST_TIMEOUT = 2.0


@dataclass(frozen=True, slots=True)
class DrawnRobot:
    """A robot to draw beside the first one.

    Attributes:
        robot_description: `example-robot-data:<robot>` or a URDF.
        arm_id: Takes the place of `panda` in a Panda's joint names.
        base: Pose of the root link: x, y, z [m], roll, pitch, yaw [rad].
    """

    robot_description: str
    arm_id: str
    base: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class DashboardConfig:
    """The configuration of a dashboard.

    Attributes:
        url: The station's API, e.g. `http://127.0.0.1:8000`.
        token: The token the dashboard itself acts with; an operator's.
        host: Address to listen at.
        port: TCP port; 0 for any free one.
        robot_description: The robot to draw, `example-robot-data:<robot>` or a URDF;
            empty draws none.
        arm_id: Takes the place of `panda` in a Panda's joint names.
        base: Pose of the root link: x, y, z [m], roll, pitch, yaw [rad].
        base_moves: Whether the root link floats or drives instead.
        beside: Further robots of the same station, e.g. the second arm.
        host_names: Further names under which users reach the dashboard.
        watchdog_url: The listener of the station's watchdog; empty when there is none.
        ca: File of the certificates to trust with https; None for those of the station
            on this machine, or of the system.
        viewer_token: The viewer's token, for viewers whose session outlives a station;
            empty when it is not known.
        sessions: Keeps logins beyond the life of this process; without it, everybody
            logs in anew after a restart of the dashboard.
        follower: Says which station takes the place of one that has crashed, and when
            to end; None stays with the station at `url` until a signal comes.
    """

    url: str
    token: str
    host: str = "127.0.0.1"
    port: int = 8080
    robot_description: str = "example-robot-data:panda"
    arm_id: str = "panda"
    base: tuple[float, ...] = (0.0,) * 6
    base_moves: bool = False
    beside: tuple[DrawnRobot, ...] = ()
    host_names: tuple[str, ...] = ()
    watchdog_url: str = ""
    ca: str | None = None
    viewer_token: str = ""
    sessions: SessionStore | None = None
    follower: StationFollower | None = None


def run_dashboard(
    config: DashboardConfig, on_ready: Callable[[str], None] = lambda _: None
) -> int:
    """Run the dashboard until SIGINT, SIGTERM, or the end that its follower announces.

    If a robot cannot be drawn, the dashboard runs without the robots and says so.

    Args:
        config: Its configuration.
        on_ready: Called with the dashboard's address once it answers.

    Returns:
        The exit code: 0.

    Raises:
        OSError: The port cannot be used.
    """
    # Before anything is loaded: a port that is taken is an error at once.
    with _listen(config) as listener:
        # Python would search all that is imported for garbage, at the end for 0.8 s.
        gc.freeze()
        asyncio.run(_serve(config, listener, on_ready))
    return 0


def dashboard_url(host: str, port: int) -> str:
    """Return the address of a dashboard, as a browser takes it."""
    name = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(host, host)
    return f"http://{f'[{name}]' if ':' in name and '[' not in name else name}:{port}"


def _listen(config: DashboardConfig) -> socket.socket:
    family = socket.AF_INET6 if ":" in config.host else socket.AF_INET
    return socket.create_server((config.host, config.port), family=family)


async def _serve(
    config: DashboardConfig,
    listener: socket.socket,
    on_ready: Callable[[str], None],
) -> None:
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ended.set)
    robots, not_drawn = _load(config)
    guarded = open_viser("Controls")
    api = _client(config)
    relay = ViserRelay(guarded.port, guarded.secret)
    shown = _client(config)
    button = StopButton(api, config.token, config.watchdog_url)
    # The dashboard's own client belongs to Viser's event loop.
    viser_loop = guarded.server.get_event_loop()
    logged_in = Sessions(store=config.sessions)

    def lease_changed(lease: str | None) -> None:
        viser_loop.call_soon_threadsafe(dashboard.act_under, lease)

    sessions = SessionAccess(
        StationAccess(
            config.url, config.token, config.watchdog_url, config.viewer_token
        ),
        lease_changed,
        follows=config.follower is not None,
        ca=config.ca,
    )
    shown.begin_within(sessions.deadline)
    pusher = SessionPusher(sessions, logged_in)
    dashboard = Dashboard(
        guarded.server,
        shown,
        next(iter(robots), None),
        not_drawn,
        robots[1:],
        guarded.session_key,
        pusher,
        pusher.move,
    )
    forwarded = ApiRelay(sessions, api.tls)
    server = _Server(
        _gateway(config, button, dashboard, relay, forwarded, sessions, logged_in)
    )

    def move_to(access: StationAccess | None) -> None:
        sessions.move_to(access)
        url, token = (api.url, None) if access is None else (access.url, access.token)
        api.talk_to(url, token)
        viser_loop.call_soon_threadsafe(dashboard.talk_to, url, token)
        # STOP keeps its former addresses until the next station is known.
        if access is not None:
            button.move_to(access.token, access.watchdog_url)
            logged_in.move_to(access.url)

    dashboard.start()
    try:
        serving = asyncio.create_task(server.serve(sockets=[listener]))
        on_ready(dashboard_url(config.host, listener.getsockname()[1]))
        await _wait_for_end(ended, serving, config.follower, move_to)
        server.should_exit = True
        await serving
    finally:
        await dashboard.stop()
        # Its connections belong to Viser's event loop, which ends with Viser.
        await asyncio.wrap_future(
            asyncio.run_coroutine_threadsafe(pusher.close(), viser_loop)
        )
        guarded.stop()
        for part in (relay, forwarded, sessions, api):
            await part.close()


def _client(config: DashboardConfig) -> AsyncStationClient:
    return AsyncStationClient(
        config.url, config.token, timeout=_REQUEST_TIMEOUT, ca=config.ca
    )


def _load(config: DashboardConfig) -> tuple[list[RobotModel], str]:
    """Return the robots, or none and the reason why they cannot be drawn."""
    if not config.robot_description:
        return [], ""
    try:
        first = load_robot(
            config.robot_description,
            config.arm_id,
            config.base,
            moves=config.base_moves,
        )
        return [
            first,
            *(load_robot(r.robot_description, r.arm_id, r.base) for r in config.beside),
        ], ""
    except RobotModelError as error:
        _logger.warning("%s", error)
        return [], str(error)


async def _wait_for_end(
    ended: asyncio.Event,
    serving: asyncio.Task[None],
    follower: StationFollower | None,
    move_to: Callable[[StationAccess | None], None],
) -> None:
    """Wait for a signal, the server's end, or the end that the follower announces."""
    access = None if follower is None else follower.access
    if follower is not None:
        follower.is_serving = True
    while not ended.is_set() and not serving.done():
        if follower is not None:
            if follower.is_over:
                return
            if follower.access is not access:
                access = follower.access
                move_to(access)
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(ended.wait(), _LOOK_PERIOD)


def _gateway(
    config: DashboardConfig,
    button: StopButton,
    dashboard: Dashboard,
    relay: ViserRelay,
    forwarded: ApiRelay,
    access: SessionAccess,
    logged_in: Sessions,
) -> Starlette:
    async def role_of(token: str) -> Role | None:
        return await ask_role(access.url, token, config.ca)

    async def release(session: BrowserSession, *, arm: bool) -> StopState:
        async with access.client_of(session) as client:
            return await client.release_stop(arm=arm)

    return build_gateway(
        GatewayParts(
            role_of=role_of,
            stop=button.press,
            release=release,
            bar=dashboard.bar,
            relay=relay,
            api=forwarded,
            workspace=WorkspaceParts(
                dashboard.view,
                access,
                dashboard.triangles,
                dashboard.not_drawn,
                dashboard.movers,
            ),
            views=dashboard.shown_views(),
            origins=origin_policy(config.host, config.host_names),
            sessions=logged_in,
        )
    )


async def ask_role(url: str, token: str, ca: str | None = None) -> Role | None:
    """Ask the station which role a token has.

    Args:
        url: The station's API.
        token: The text that a person entered.
        ca: File of the certificates to trust with https, see `DashboardConfig`.

    Returns:
        The role, or None for a wrong token.

    Raises:
        ApiError: The station does not answer, or answers with another error.
    """
    if not token.isascii() or not token.isprintable():
        return None
    async with AsyncStationClient(
        url, token, timeout=_REQUEST_TIMEOUT, ca=ca
    ) as client:
        try:
            return Role((await client.session()).role)
        except ApiError as error:
            if error.status in {401, 403}:
                return None
            raise


class _Server(LimitedServer):
    """Uvicorn that leaves signals to `_serve` and does not wait for browsers."""

    def __init__(self, app: Starlette) -> None:
        super().__init__(
            uvicorn.Config(
                app,
                log_level="warning",
                access_log=False,
                ws=SocketProtocol,
                ws_per_message_deflate=False,
                timeout_graceful_shutdown=_CLOSING_TIME,
                server_header=False,
            ),
            connection_share(_DESCRIPTORS),
        )

    @override
    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Take no signal: uvicorn would raise it again after its end."""
        yield
