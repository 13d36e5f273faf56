"""The latched stop, which is a software stop and not a safety device.

The stop runs in the event loop itself, so that it does not wait for other requests. The
robot stops whatever the body of the request is.
"""

import asyncio

from fastapi import Request
from pydantic import ValidationError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from station.api import answers
from station.api.dependencies import RoleDep, StationDep, Viewer
from station.api.routes.routing import ApiRouter, change, problems, routes_of
from station.core.loop.stop_latch import StopLatch
from station.wire import ReleaseRequest, StopRequest, StopState

BODY_TIMEOUT = 0.01
"""Longest wait of a stop for the reason in its body [s]."""
CARRY_OUT_TIMEOUT = 0.1
"""Longest wait of the answer for the cycle that stops the controllers [s]."""
_STOP_BODY = {
    "requestBody": {
        "content": {
            "application/json": {"schema": StopRequest.model_json_schema()},
        },
        "required": False,
    }
}

router = ApiRouter(tags=["stop"], dependencies=[Viewer])
_release = routes_of("stop")


@router.get("/stop", responses=problems())
async def get_stop(station: StationDep) -> StopState:
    """Return the state of the stop."""
    return answers.stop_state(station)


@router.post("/stop", responses=problems(413), openapi_extra=_STOP_BODY)
async def stop(station: StationDep, role: RoleDep, request: Request) -> StopState:
    """Stop every controller in the next cycle; every token allows this.

    The body is optional; an unreadable body is ignored. A second stop has another
    reason and makes commands void once more. Nothing moves until the stop is released
    and armed.
    """
    station.stop(await _reason(request) or f"The {role.value} asked for it.")
    await _carried_out(station.loop.stop_latch)
    return answers.stop_state(station)


async def _reason(request: Request) -> str:
    try:
        body = await asyncio.wait_for(request.body(), BODY_TIMEOUT)
        return StopRequest.model_validate_json(body).reason
    except (ValidationError, HTTPException, ClientDisconnect, TimeoutError):
        return ""  # the robot stops anyway; the answer has the kept reason


async def _carried_out(latch: StopLatch) -> None:
    for _ in range(round(CARRY_OUT_TIMEOUT / 0.002)):
        if not latch.pending:
            return
        await asyncio.sleep(0.002)


@_release.post("/stop/release", **change(413, 422, 423))
def release_stop(
    station: StationDep, request: ReleaseRequest | None = None
) -> StopState:
    """Release the stop; a second call with `arm` allows motion again.

    Nothing resumes by itself: controllers must be started again.
    """
    station.release_stop(arm=request is not None and request.arm)
    return answers.stop_state(station)


router.join(_release)
