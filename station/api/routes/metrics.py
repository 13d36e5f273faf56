"""The figures for Prometheus, at the root as its convention has it."""

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST

from station.api import metrics
from station.api.dependencies import ServicesDep, Viewer

router = APIRouter(include_in_schema=False, dependencies=[Viewer])


@router.get("/metrics")
def get_metrics(services: ServicesDep) -> Response:
    """Return all figures in Prometheus' text format."""
    log = services.event_recorder.log
    return Response(
        metrics.render(services.station, services.broadcaster, log),
        media_type=CONTENT_TYPE_LATEST,
    )
