"""The addresses at `/` and the page `/docs`, for people who look for the API.

They need no token, and contain nothing about the robot.
"""

from importlib.resources import files
from typing import TYPE_CHECKING

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse

import station as package
from station.api import asyncapi
from station.api.dependencies import ServicesDep
from station.api.errors import ProblemError
from station.wire.protocol import PREFIX

if TYPE_CHECKING:
    from station.api.openapi import StationApi

router = APIRouter(include_in_schema=False)
_STREAMS = asyncapi.document()
REVALIDATED = {"Cache-Control": "no-cache"}
"""A browser may cache the documents, but must ask whether they have changed."""
# `fastapi-offline` provides the files, but its page is not used: the page's inline
# script would need a weaker content security policy.
POLICY = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
)
ASSETS = {
    "swagger-ui-bundle.js": "text/javascript",
    "swagger-ui.css": "text/css",
}
PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Control station: API</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="docs/swagger-ui.css">
<div id="swagger-ui"></div>
<script src="docs/swagger-ui-bundle.js"></script>
<script src="docs/start.js"></script>
</html>
"""
START = """SwaggerUIBundle({
  url: "api/v1/openapi.json",
  dom_id: "#swagger-ui",
  deepLinking: true,
  tryItOutEnabled: true,
  presets: [SwaggerUIBundle.presets.apis],
});
"""


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
    """Return the AsyncAPI document; it needs no token."""
    response.headers.update(REVALIDATED)
    return _STREAMS


@router.get("/docs")
async def docs() -> Response:
    """Return the page; it needs no token, but trying out operations does."""
    return HTMLResponse(PAGE, headers={"Content-Security-Policy": POLICY})


@router.get("/docs/start.js")
async def start() -> Response:
    """Return the script with which the page opens the document."""
    return Response(START, media_type="text/javascript")


@router.get("/docs/{name}")
def asset(name: str) -> Response:
    """Return a file of the page.

    Raises:
        ProblemError: There is no such file.
    """
    media_type = ASSETS.get(name)
    if media_type is None:
        raise ProblemError(
            404, "route_not_found", f"There is no /docs/{name:.80}.", "Open /docs."
        )
    content = (files("fastapi_offline") / "static" / name).read_bytes()
    return Response(content, media_type=media_type)
