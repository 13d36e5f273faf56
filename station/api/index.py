"""The addresses at `/`, for visitors who need to know where to go.

No token is needed, and nothing is said about the robot.
"""

from typing import TYPE_CHECKING

from fastapi import APIRouter, Request, Response

import station as package
from station.api import asyncapi
from station.api.dependencies import ServicesDep
from station.wire.protocol import PREFIX

if TYPE_CHECKING:
    from station.api.openapi import StationApi

router = APIRouter(include_in_schema=False)
_STREAMS = asyncapi.document()
REVALIDATED = {"Cache-Control": "no-cache"}
"""A browser may keep the documents, and asks whether they are still the same."""


@router.get("/")
async def index(services: ServicesDep) -> dict[str, str]:
    """Return the addresses of the station's parts, relative to this server."""
    dashboard = services.dashboard_url()
    known = {} if dashboard is None else {"dashboard": dashboard}
    return {
        "station": package.__version__,
        "docs": "/docs",
        "openapi": f"{PREFIX}/openapi.json",
        "asyncapi": f"{PREFIX}/asyncapi.json",
        "api": PREFIX,
        "health": f"{PREFIX}/health",
        "ready": f"{PREFIX}/ready",
        "metrics": "/metrics",
        "login": "/login?token=…",
        **known,
    }


@router.get(f"{PREFIX}/openapi.json")
async def openapi_document(request: Request) -> Response:
    """Return the OpenAPI document; it needs no token."""
    app: StationApi = request.app
    return Response(
        await app.openapi_json(), media_type="application/json", headers=REVALIDATED
    )


@router.get(f"{PREFIX}/asyncapi.json")
async def streams_document(response: Response) -> dict[str, object]:
    """Return the AsyncAPI document, which needs no token, as the OpenAPI document."""
    response.headers.update(REVALIDATED)
    return _STREAMS
