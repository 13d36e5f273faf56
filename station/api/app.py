"""The web application: routes, errors, access, documentation."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastapi import FastAPI
from starlette.middleware.cors import CORSMiddleware

import station as package
from station.api import index, metrics
from station.api.agents import AgentPolicy, Agents
from station.api.audit import Audit, EventRecorder
from station.api.auth import Authenticator
from station.api.cameras import Cameras
from station.api.control import Control
from station.api.errors import add_error_handlers
from station.api.event_feed import EventFeed
from station.api.guard import Guard
from station.api.idempotency import IdempotentAnswers
from station.api.openapi import StationApi
from station.api.representation import Representation
from station.api.routes import api_router, robots
from station.api.routes.access import login_page
from station.api.services import Services
from station.api.streams import Broadcaster
from station.core.facade.station import Station
from station.events import Alarms, EventLog
from station.library.gain_sets import GainSets
from station.library.path_player import PathPlayer, PlayOptions
from station.library.waypoint_paths import WaypointPaths
from station.library.yaml_folder import PlotLayouts, SavedScenes
from station.rehearsal.rehearsals import Rehearsals
from station.trials.background_experiments import BackgroundExperiments
from station.trials.bench_analysis import KeptRuns
from station.trials.lesson_attempts import LessonAttempts
from station.trials.live_bench import LiveBench
from station.web.failed_logins import FailedLogins
from station.web.host_policy import HostPolicy
from station.web.request_id import HEADER as REQUEST_ID_HEADER, RequestId
from station.wire.protocol import (
    CLOCK_HEADER,
    KEY_HEADER,
    LEASE_HEADER,
    MAX_BODY_BYTES,
    NOT_AFTER_HEADER,
    REHEARSAL_HEADER,
    REPLAYED_HEADER,
)

if TYPE_CHECKING:
    from station.records.recorder import Recorder

DESCRIPTION = """
Everything a station can do, for programs and browsers. Errors are problem documents
(RFC 9457): `detail` says which thing, its value and what is allowed, `remedy` what to
do; a refused request changes nothing. Units are SI.
"""

_METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")
"""Methods that pages of an allowed origin may use."""
_REQUEST_HEADERS = (
    "Authorization",
    "Content-Type",
    KEY_HEADER,
    "If-Match",
    "If-None-Match",
    "Last-Event-ID",
    LEASE_HEADER,
    NOT_AFTER_HEADER,
    REQUEST_ID_HEADER,
)
"""Headers that these pages may send. They have no cookie, and send a token."""
_ANSWER_HEADERS = (
    "ETag", REPLAYED_HEADER, REQUEST_ID_HEADER, CLOCK_HEADER, REHEARSAL_HEADER
)  # fmt: skip
"""Headers of answers that these pages may read."""


@dataclass(frozen=True, slots=True)
class Kept:
    """Data that a station keeps on disk.

    Attributes:
        events: Log of the events; by default a log in memory.
        recorder: Records every cycle; None for a station without recordings.
        experiments: Runs experiments; None for a station without experiments.
        gain_sets: Folder of the gain sets; None for the user's own.
        plot_layouts: Folder of the plot layouts; None for the user's own.
        scenes: Folder of the scenes; None for the user's own.
        waypoint_paths: Folder of the waypoint paths; None for the user's own.
        bench_runs: Folder of the runs of the bench; None for the user's own.
        lessons: Folder of the user's lessons; None for the user's own.
    """

    events: EventLog = field(default_factory=EventLog)
    recorder: "Recorder | None" = None
    experiments: BackgroundExperiments | None = None
    gain_sets: Path | None = None
    plot_layouts: Path | None = None
    scenes: Path | None = None
    waypoint_paths: Path | None = None
    bench_runs: Path | None = None
    lessons: Path | None = None


def create_app(  # noqa: PLR0913 - parts and bounds of one application
    station: Station,
    authenticator: Authenticator,
    policy: HostPolicy | None = None,
    *,
    slow_after: float = 5.0,
    max_streams: int = 64,
    max_body: int = MAX_BODY_BYTES,
    dashboard_url: Callable[[], str | None] = lambda: None,
    kept: Kept | None = None,
    agents: AgentPolicy | None = None,
    cameras: Cameras | None = None,
) -> FastAPI:
    """Return the application that serves `station`.

    Args:
        station: The station that the API serves.
        authenticator: Knows the tokens.
        policy: Allowed hosts and origins; by default localhost and numeric hosts.
        slow_after: Time without reading after which a client's stream is closed [s].
        max_streams: Most streams at a time.
        max_body: Largest request body [bytes].
        dashboard_url: Function that returns the URL of the dashboard; None while it is
            unknown.
        kept: Events, recordings and other data on disk; by default only events, in
            memory.
        agents: Rules for agents; by default a person must allow each change.
        cameras: Cameras; by default none.
    """
    app = StationApi(
        title="Control station",
        version=package.__version__,
        description=DESCRIPTION,
        # Spans and counters of telemetry would cost time in every request.
        telemetry={"tracing": False, "metrics": False, "logs": False},
    )
    kept = kept or Kept()
    streams = Broadcaster(station, slow_after=slow_after, max_clients=max_streams)
    seat = Agents(station, kept.events, agents or AgentPolicy())
    services = _services(station, authenticator, kept, seat, streams)
    if cameras is not None:
        services.cameras = cameras
    services.dashboard_url = dashboard_url
    app.state.services = services
    add_error_handlers(app)
    declared = robots.declared(station)
    for router in (api_router, login_page, index.router, metrics.router, declared):
        app.router.routes.extend(router.routes)
    policy = policy or HostPolicy()
    app.add_middleware(Representation)
    if policy.origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=sorted(policy.origins),
            allow_methods=_METHODS,
            allow_headers=_REQUEST_HEADERS,
            expose_headers=_ANSWER_HEADERS,
            allow_private_network=True,
        )
    app.add_middleware(Guard, policy=policy, max_body=max_body)
    app.add_middleware(Audit, repeats=services.event_recorder.repeats)
    app.add_middleware(RequestId)
    return app


def _services(
    station: Station,
    authenticator: Authenticator,
    kept: Kept,
    seat: Agents,
    streams: Broadcaster,
) -> Services:
    """Return the services of an application."""
    paths = WaypointPaths(station.loop, station.manager, kept.waypoint_paths)
    player = PathPlayer(station.loop, station.manager, station.motion, paths)
    rehearsals = Rehearsals(station, {"path": partial(_plan_path, player)})
    control = Control(kept.events, station.motion.let_go, rehearsed=rehearsals.check)
    control.listen(seat.withdraw)
    runs = KeptRuns(kept.bench_runs)
    return Services(
        station=station,
        authenticator=authenticator,
        failed_logins=FailedLogins(),
        event_recorder=EventRecorder(kept.events),
        event_feed=EventFeed(kept.events),
        alarms=Alarms(station, kept.events),
        control=control,
        agents=seat,
        idempotent_answers=IdempotentAnswers(),
        bench=LiveBench(station),
        bench_runs=runs,
        lessons=LessonAttempts(station, runs, kept.lessons),
        broadcaster=streams,
        recorder=kept.recorder,
        experiments=kept.experiments,
        gain_sets=GainSets(station.tuning, kept.gain_sets),
        plot_layouts=PlotLayouts(kept.plot_layouts),
        scenes=SavedScenes(kept.scenes),
        waypoint_paths=paths,
        path_player=player,
        rehearsals=rehearsals,
        cameras=Cameras(),
    )


def _plan_path(player: PathPlayer, step: Mapping[str, Any]) -> dict[str, object]:
    """Return the trajectory goal for a step of a rehearsal that plays a path."""
    return player.plan_goal(step["path"], PlayOptions(**step["options"]))
