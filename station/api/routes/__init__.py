"""The routes, in one file per resource; `api_router` has all routes."""

from fastapi import APIRouter

from station.api.routes import (
    access,
    bench,
    cameras,
    commands,
    control,
    controllers,
    events,
    experiments,
    gains,
    hardware,
    lessons,
    library,
    recordings,
    rehearsals,
    robots,
    simulation,
    status,
    stop,
    streams,
    tokens,
)
from station.wire.protocol import PREFIX

api_router = APIRouter(prefix=PREFIX)
for _module in (
    status,
    access,
    controllers,
    gains,
    library,
    commands,
    bench,
    rehearsals,
    recordings,
    experiments,
    lessons,
    cameras,
    robots,
    hardware,
    simulation,
    stop,
    control,
    tokens,
    events,
    streams,
):
    api_router.include_router(_module.router)
api_router.include_router(recordings.uploads)
api_router.include_router(cameras.pictures)
