"""Serve a socket until the first of several things ends it."""

import asyncio
import contextlib

from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState


async def until_first(*ends: "asyncio.Future[None]") -> None:
    """Wait for the first of several ends, and cancel the others.

    Args:
        ends: The possible ends of the socket; all are over when this returns.

    Raises:
        BaseException: An end raised it; expected ends return instead.
    """
    try:
        await asyncio.wait(ends, return_when=asyncio.FIRST_COMPLETED)
    finally:
        over = {end for end in ends if end.done()}
        for end in ends:
            end.cancel()
        await asyncio.gather(*ends, return_exceptions=True)
    for end in over:
        if not end.cancelled() and (error := end.exception()) is not None:
            raise error


async def send_frame(browser: WebSocket, frame: str | bytes) -> bool:
    """Send a frame to a browser; return whether the browser is still there.

    Args:
        browser: The browser's socket.
        frame: Frame to send.
    """
    try:
        if isinstance(frame, bytes):
            await browser.send_bytes(frame)
        else:
            await browser.send_text(frame)
    except WebSocketDisconnect:
        return False
    except RuntimeError:
        # Uvicorn has answered the browser's close, which was not received here yet.
        return False
    return True


async def close_socket(browser: WebSocket, code: int, reason: str) -> None:
    """Close a browser's socket, unless either side has done so already.

    Args:
        browser: The browser's socket.
        code: The code of the close.
        reason: Why, for people.
    """
    if browser.application_state is not WebSocketState.CONNECTED:
        return
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):  # As in `send_frame`.
        await browser.close(code, reason)
