"""The figures for Prometheus, at the root as its convention has it."""

from typing import TYPE_CHECKING

from fastapi import APIRouter, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST

from station.api import metrics
from station.api.dependencies import EventRecorderDep, StationDep, Viewer

if TYPE_CHECKING:
    from station.api.streams import Broadcaster

router = APIRouter(include_in_schema=False, dependencies=[Viewer])


@router.get("/metrics")
def get_metrics(
    request: Request, station: StationDep, event_recorder: EventRecorderDep
) -> Response:
    """Return all figures in Prometheus' text format."""
    broadcaster: Broadcaster = request.app.state.broadcaster
    return Response(
        metrics.render(station, broadcaster, event_recorder.log),
        media_type=CONTENT_TYPE_LATEST,
    )
