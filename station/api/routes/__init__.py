"""The routes, in one file per resource; `api_router` has all routes."""

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
    library,
    recordings,
    rehearsals,
    robots,
    simulation,
    status,
    stop,
    streams,
)
from station.api.routes.routing import ApiRouter

api_router = ApiRouter()
api_router.join(
    status.router,
    access.router,
    controllers.router,
    gains.router,
    library.router,
    commands.router,
    bench.router,
    rehearsals.router,
    recordings.router,
    experiments.router,
    bench.lessons,
    cameras.router,
    robots.router,
    status.components,
    simulation.router,
    stop.router,
    control.router,
    access.tokens,
    events.router,
    streams.router,
    recordings.uploads,
    cameras.pictures,
)
