"""Cameras that look at the robots, and their pictures."""

from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import Path
from starlette.responses import Response, StreamingResponse

from station import wire
from station.api.dependencies import ServicesDep, Viewer
from station.api.routes.routing import ApiRouter, problems, routes_of
from station.wire.base import FileName

router = routes_of("cameras")
pictures = ApiRouter(tags=["cameras"], dependencies=[Viewer])
"""Routes whose answers are not JSON."""
STAMP_HEADER = "X-Station-Time"
"""Header of a picture: the station time that it shows [s]."""
_BOUNDARY = "picture"
Name = Annotated[FileName, Path(description="Name of the camera.", examples=["cell"])]


def _answers(media_type: str) -> dict[int | str, dict[str, Any]]:
    content = {media_type: {"schema": {"type": "string", "format": "binary"}}}
    return {
        200: {"description": "What it sees.", "content": content},
        **problems(404, 422, 503),
    }


@router.get("/cameras", responses=problems())
def list_cameras(services: ServicesDep) -> wire.Cameras:
    """List the cameras; the `fault` of a camera says why it has no pictures."""
    return wire.Cameras(cameras=services.cameras.reports())


@pictures.get(
    "/cameras/{name}", response_class=Response, responses=_answers("image/jpeg")
)
async def get_picture(name: Name, services: ServicesDep) -> Response:
    """Return a picture that has just been drawn, with its station time in a header."""
    found = await services.cameras.picture(name)
    headers = {STAMP_HEADER: f"{found.stamp:.6f}", "Cache-Control": "no-store"}
    return Response(found.jpeg, media_type="image/jpeg", headers=headers)


@pictures.get(
    "/cameras/{name}/stream",
    response_class=Response,
    responses=_answers(f"multipart/x-mixed-replace; boundary={_BOUNDARY}"),
)
async def stream_pictures(name: Name, services: ServicesDep) -> Response:
    """Return a sequence of pictures in one answer, for `<img>` and video players."""
    await services.cameras.picture(name)  # raises errors before the first byte

    async def parts() -> AsyncIterator[bytes]:
        async for found in services.cameras.pictures(name):
            head = (
                f"--{_BOUNDARY}\r\nContent-Type: image/jpeg\r\n"
                f"Content-Length: {len(found.jpeg)}\r\n"
                f"{STAMP_HEADER}: {found.stamp:.6f}\r\n\r\n"
            )
            yield head.encode() + found.jpeg + b"\r\n"

    media = f"multipart/x-mixed-replace; boundary={_BOUNDARY}"
    return StreamingResponse(parts(), media_type=media)
