"""Routers, and options of routes: the needed role, and the errors for OpenAPI."""

from typing import Any

from fastapi import APIRouter
from fastapi.routing import APIRoute

from station.api.dependencies import Operator, Viewer
from station.api.json_route import JsonRoute
from station.wire.protocol import PREFIX

MEANINGS = {
    401: "No token or session that the station knows.",
    403: "The role does not suffice, or the request comes from the wrong place.",
    404: "There is no such thing; the detail lists what there is.",
    409: "Not possible in the present state; the detail names what is in the way.",
    412: "Something has changed: the gains, or what was rehearsed.",
    413: "The body is too large.",
    415: "The body is not JSON.",
    422: "Malformed; 'errors' names every field.",
    423: "The station is stopped, or somebody else holds control.",
    426: "This is a WebSocket.",
    428: "The motion has to be rehearsed first.",
    429: "Too many of them; the detail says when the next one is possible.",
    503: "The control loop does not run, or the station cannot be copied.",
    504: "The switch missed its deadline and was withdrawn.",
}


def operation_id(route: APIRoute) -> str:
    """Return the name of a route's function, which is unique and stable."""
    return route.name


class ApiRouter(APIRouter):
    """A router of the API, whose routes are complete as soon as they are declared.

    Routers are joined. To include one in another, the framework makes each route once
    more, which took a quarter of the start of a station, and looks for the route of a
    request in every router in between.

    Args:
        prefix: Beginning of the paths, after `/api/v1`.
        options: Other options of FastAPI's router.
    """

    def __init__(self, prefix: str = "", **options: Any) -> None:  # noqa: ANN401 - those of the framework
        super().__init__(
            prefix=PREFIX + prefix, generate_unique_id_function=operation_id, **options
        )

    def join(self, *others: APIRouter) -> None:
        """Take over the routes of other routers."""
        for other in others:
            self.routes.extend(other.routes)


def routes_of(
    tag: str, prefix: str = "", kind: type[JsonRoute] = JsonRoute
) -> ApiRouter:
    """Return a router for routes that need the viewer role at least.

    Args:
        tag: Tag of the routes in the OpenAPI document.
        prefix: Beginning of their paths.
        kind: Kind of the routes.
    """
    return ApiRouter(prefix, tags=[tag], dependencies=[Viewer], route_class=kind)


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI entries of some statuses, and of those of every route.

    A route that may refuse a body as too large may also refuse it as not JSON.
    """
    with_body = (415,) if 413 in statuses else ()
    return {
        status: {"description": MEANINGS[status]}
        for status in sorted({401, 403, *statuses, *with_body})
    }


def change(*statuses: int) -> dict[str, Any]:
    """Return the options of a route that makes changes: its role and its errors.

    Every such route may refuse its query or `X-Not-After` as malformed.
    """
    return {"dependencies": [Operator], "responses": problems(422, *statuses)}
