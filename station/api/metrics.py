"""Figures of the station for Prometheus, collected when they are requested.

The control thread does no extra work for them. Counters are numbers that the station
keeps anyway and never resets, so a reset of the statistics does not set them back.
Figures that a reset clears (percentiles) are gauges.
"""

from collections.abc import Iterable, Iterator

from fastapi import APIRouter, Response
from prometheus_client import (
    CONTENT_TYPE_LATEST,
    CollectorRegistry,
    ProcessCollector,
    generate_latest,
)
from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    InfoMetricFamily,
    Metric,
)
from prometheus_client.registry import Collector
from typing_extensions import override

import station as package
from station.api.dependencies import ServicesDep, Viewer
from station.api.streams import Broadcaster
from station.core.facade.station import Station
from station.core.loop.stop_latch import StopState
from station.events import EventLog
from station.reports import LoopState, Percentiles

router = APIRouter(include_in_schema=False, dependencies=[Viewer])
PHASES = ("read", "update", "write", "total")


class StationCollector(Collector):
    """Reads the figures of a station. Any thread.

    Args:
        station: The station.
        broadcaster: Its streams.
        events: Its event log.
    """

    def __init__(
        self, station: Station, broadcaster: Broadcaster, events: EventLog
    ) -> None:
        self._station = station
        self._broadcaster = broadcaster
        self._events = events

    @override
    def collect(self) -> Iterable[Metric]:
        """Return the present values of all figures."""
        yield from self._station_figures()
        yield from self._loop_figures()
        yield from self._controller_figures()
        yield from self._limit_figures()
        yield from self._event_figures()

    def _event_figures(self) -> Iterator[Metric]:
        state = self._events.state()
        yield GaugeMetricFamily(
            "station_events_newest", "Number of the newest event.", state.newest_id
        )
        yield CounterMetricFamily(
            "station_events_lost",
            "Events of this run that could not be kept on disk.",
            state.lost,
        )
        yield GaugeMetricFamily(
            "station_events_failing",
            "Whether events cannot be written to disk at the moment.",
            float(state.failure is not None),
        )

    def _station_figures(self) -> Iterator[Metric]:
        station = self._station
        labels = {
            "version": package.__version__,
            "boot_id": station.boot_id,
            "robot_type": station.status().robot_type,
        }
        yield InfoMetricFamily("station", "The station of this run.", labels)
        yield GaugeMetricFamily(
            "station_ready",
            "Whether the loop runs and its last cycle is fresh.",
            float(station.ready() is None),
        )
        yield GaugeMetricFamily(
            "station_watchdog_failing",
            "Whether a watchdog is wanted and none looks at the loop.",
            float(station.watchdog_failure is not None),
        )
        yield GaugeMetricFamily(
            "station_stopped",
            "Whether the stop is engaged, or released and not armed.",
            float(station.loop.stop_latch.state is not StopState.ARMED),
        )
        yield CounterMetricFamily(
            "station_epochs",
            "Stops, resets and recoveries, each of which begins an epoch.",
            station.epoch,
        )
        yield GaugeMetricFamily(
            "station_stream_clients",
            "Clients of WebSocket streams.",
            self._broadcaster.clients,
        )

    def _loop_figures(self) -> Iterator[Metric]:
        loop, report = self._station.loop, self._station.loop.report()
        yield GaugeMetricFamily(
            "station_loop_running",
            "Whether the control thread runs.",
            float(report.state is LoopState.RUNNING),
        )
        yield CounterMetricFamily(
            "station_cycles", "Cycles of the control loop.", loop.cycle
        )
        yield CounterMetricFamily(
            "station_skipped_deadlines",
            "Deadlines that had passed before their cycle could begin.",
            loop.skipped,
        )
        yield CounterMetricFamily(
            "station_time_seconds", "Station time that has passed.", loop.time
        )
        yield GaugeMetricFamily(
            "station_loop_rate_hertz", "Rate asked for.", report.rate
        )
        lateness = _statistics(
            "station_loop_lateness_seconds",
            "How long after its deadline a cycle began, since the last reset.",
        )
        _add_statistics(lateness, [], report.lateness)
        yield lateness
        phases = _statistics(
            "station_loop_phase_seconds",
            "How long the parts of a cycle take, since the last reset.",
            "phase",
        )
        for phase in PHASES:
            _add_statistics(phases, [phase], getattr(report, phase))
        yield phases

    def _controller_figures(self) -> Iterator[Metric]:
        label = ["controller"]
        running = GaugeMetricFamily(
            "station_controller_running", "Whether a controller runs.", labels=label
        )
        updates = CounterMetricFamily(
            "station_controller_updates",
            "Updates of a controller since it was loaded.",
            labels=label,
        )
        overruns = CounterMetricFamily(
            "station_controller_overruns",
            "Updates that took longer than the period, since it was loaded.",
            labels=label,
        )
        durations = _statistics(
            "station_controller_update_seconds",
            "How long an update takes, since the last reset.",
            "controller",
        )
        for found in self._station.manager.controller_statistics():
            running.add_metric([found.name], float(found.running))
            updates.add_metric([found.name], found.total_updates)
            overruns.add_metric([found.name], found.total_overruns)
            _add_statistics(durations, [found.name], found.time)
        faulty = GaugeMetricFamily(
            "station_controller_faulty",
            "Whether the station stopped a controller because of a fault.",
            labels=label,
        )
        for status in self._station.controllers():
            faulty.add_metric([status.name], float(status.fault is not None))
        yield from (running, updates, overruns, durations, faulty)

    def _limit_figures(self) -> Iterator[Metric]:
        clamps = CounterMetricFamily(
            "station_clamped_commands",
            "Commands that a limit cut off.",
            labels=["joint", "hardware_interface"],
        )
        for clamp in self._station.loop.hw.clamps():
            labels = [clamp.last.joint, clamp.hardware_interface]
            clamps.add_metric(labels, clamp.count)
        yield clamps
        yield CounterMetricFamily(
            "station_command_violations",
            "Commands that were written without a claim, and put to rest.",
            self._station.manager.command_violations[0],
        )


def _statistics(name: str, text: str, *labels: str) -> GaugeMetricFamily:
    # The label `quantile` is for summaries, whose sums must not be reset, so this label
    # has another name.
    return GaugeMetricFamily(name, text, labels=[*labels, "statistic"])


def _add_statistics(
    metric: GaugeMetricFamily, labels: list[str], found: Percentiles
) -> None:
    for statistic in ("p50", "p99", "p999", "max"):
        metric.add_metric([*labels, statistic], getattr(found, statistic))


def render(station: Station, broadcaster: Broadcaster, events: EventLog) -> bytes:
    """Return all figures in Prometheus' text format.

    Args:
        station: The station.
        broadcaster: Its streams.
        events: Its event log.
    """
    registry = CollectorRegistry()
    registry.register(StationCollector(station, broadcaster, events))
    ProcessCollector(registry=registry)
    return generate_latest(registry)


@router.get("/metrics")
def get_metrics(services: ServicesDep) -> Response:
    """Return all figures in Prometheus' text format."""
    log = services.event_recorder.log
    return Response(
        render(services.station, services.broadcaster, log),
        media_type=CONTENT_TYPE_LATEST,
    )
