"""The routes, a file for what belongs together; `api_router` has them all."""

from fastapi import APIRouter

from station.api.routes import (
    access,
    agents,
    bench,
    control,
    controllers,
    events,
    experiments,
    gains,
    goals,
    lessons,
    parameters,
    plot_layouts,
    recordings,
    rehearsals,
    robots,
    set_points,
    simulation,
    status,
    stop,
    streams,
    tokens,
    waypoint_paths,
)
from station.wire.protocol import PREFIX

api_router = APIRouter(prefix=PREFIX)
for _module in (
    status,
    access,
    controllers,
    gains,
    set_points,
    bench,
    goals,
    waypoint_paths,
    rehearsals,
    parameters,
    plot_layouts,
    recordings,
    experiments,
    lessons,
    robots,
    simulation,
    stop,
    control,
    agents,
    tokens,
    events,
    streams,
):
    api_router.include_router(_module.router)
api_router.include_router(recordings.uploads)
