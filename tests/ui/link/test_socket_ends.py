"""The ends of a socket."""

import asyncio

import pytest
from starlette.websockets import WebSocketDisconnect, WebSocketState

from station.ui.link.socket_ends import close_socket, send_frame, until_first


async def _fail():
    raise LookupError("a page without a name")


async def _serve(first):
    forever = asyncio.create_task(asyncio.Event().wait())
    await until_first(asyncio.create_task(first), forever)
    return forever


def test_the_first_end_ends_all():
    assert asyncio.run(_serve(asyncio.sleep(0))).cancelled()


def test_a_failure_is_not_swallowed():
    with pytest.raises(LookupError, match="without a name"):
        asyncio.run(_serve(_fail()))


def test_whoever_waits_may_be_cancelled():
    async def cancelled():
        waiting = asyncio.Event()
        inner = asyncio.create_task(waiting.wait())
        outer = asyncio.create_task(until_first(inner))
        await asyncio.sleep(0)
        outer.cancel()
        await asyncio.gather(outer, return_exceptions=True)
        return inner.cancelled()

    assert asyncio.run(cancelled())


class _Browser:
    """Takes what is sent until it has gone."""

    def __init__(self, failure=None, state=WebSocketState.CONNECTED):
        self.failure, self.application_state, self.sent = failure, state, []

    async def _take(self, *what):
        if self.failure is not None:
            raise self.failure
        self.sent.append(what)

    send_bytes = send_text = close = _take


GONE = [WebSocketDisconnect(1006), RuntimeError("after sending 'websocket.close'")]


@pytest.mark.parametrize("frame", [b"picture", "{}"])
def test_frames_of_either_kind_are_sent(frame):
    browser = _Browser()
    assert asyncio.run(send_frame(browser, frame))
    assert browser.sent == [(frame,)]


@pytest.mark.parametrize("failure", GONE)
def test_a_browser_that_has_gone_is_no_failure(failure):
    assert not asyncio.run(send_frame(_Browser(failure), "{}"))
    asyncio.run(close_socket(_Browser(failure), 4401, "over"))


def test_a_socket_is_closed_once():
    browser = _Browser()
    asyncio.run(close_socket(browser, 4401, "over"))
    browser.application_state = WebSocketState.DISCONNECTED
    asyncio.run(close_socket(browser, 4401, "over"))
    assert browser.sent == [(4401, "over")]
