"""The parts of an application that its routes and streams use."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from starlette.requests import HTTPConnection

if TYPE_CHECKING:
    from station.api.agents import Agents
    from station.api.audit import EventRecorder
    from station.api.auth import Authenticator
    from station.api.cameras import Cameras
    from station.api.control import Control
    from station.api.event_feed import EventFeed
    from station.api.idempotency import IdempotentAnswers
    from station.api.streams import Broadcaster
    from station.core.facade.station import Station
    from station.events import Alarms
    from station.library.gain_sets import GainSets
    from station.library.path_player import PathPlayer
    from station.library.waypoint_paths import WaypointPaths
    from station.library.yaml_folder import PlotLayouts, SavedScenes
    from station.records.recorder import Recorder
    from station.rehearsal.rehearsals import Rehearsals
    from station.trials.background_experiments import BackgroundExperiments
    from station.trials.bench_analysis import KeptRuns
    from station.trials.lesson_attempts import LessonAttempts
    from station.trials.live_bench import LiveBench
    from station.web.failed_logins import FailedLogins


@dataclass(slots=True)
class Services:
    """The parts of one application, in `app.state.services`.

    Attributes:
        station: The station that the application serves.
        authenticator: Knows tokens and sessions.
        failed_logins: Slows down the guessing of tokens.
        event_recorder: Records the changes of each client.
        event_feed: Sends events, page by page or as they happen.
        alarms: Alarms of the station.
        control: The lease of control.
        agents: Requests of agents that people answer.
        idempotent_answers: Kept answers for requests that are sent twice.
        bench: Measures responses of joints.
        bench_runs: Kept runs of the bench.
        lessons: Lessons, the present attempt, and the progress of people.
        broadcaster: All streams.
        recorder: Records every cycle; None for a station without recordings.
        experiments: Runs experiments; None for a station without experiments.
        gain_sets: Named sets of gains on the disk.
        plot_layouts: Named layouts of plots on the disk.
        scenes: Named scenes on the disk.
        waypoint_paths: Named waypoint paths on the disk.
        path_player: Plays waypoint paths.
        rehearsals: Tries commands in a copy of the station.
        cameras: Cameras, and their pictures.
        dashboard_url: Returns the URL of the dashboard; None while it is unknown.
        command_streams: Number of open streams of set-points.
    """

    station: "Station"
    authenticator: "Authenticator"
    failed_logins: "FailedLogins"
    event_recorder: "EventRecorder"
    event_feed: "EventFeed"
    alarms: "Alarms"
    control: "Control"
    agents: "Agents"
    idempotent_answers: "IdempotentAnswers"
    bench: "LiveBench"
    bench_runs: "KeptRuns"
    lessons: "LessonAttempts"
    broadcaster: "Broadcaster"
    recorder: "Recorder | None"
    experiments: "BackgroundExperiments | None"
    gain_sets: "GainSets"
    plot_layouts: "PlotLayouts"
    scenes: "SavedScenes"
    waypoint_paths: "WaypointPaths"
    path_player: "PathPlayer"
    rehearsals: "Rehearsals"
    cameras: "Cameras"
    dashboard_url: Callable[[], str | None] = lambda: None
    command_streams: int = 0


def services_of(connection: HTTPConnection) -> Services:
    """Return the services of the application that serves a request or a WebSocket."""
    services: Services = connection.app.state.services
    return services
