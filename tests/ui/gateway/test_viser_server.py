"""Viser is reached only with the gateway's secret."""

import asyncio

import httpx
import pytest
import viser
import websockets.exceptions
from websockets.asyncio.client import connect

from station.ui.gateway.viser_relay import SECRET_HEADER, open_viser


@pytest.fixture(scope="module")
def guarded():
    door = open_viser("Test")
    yield door
    door.stop()


def test_direct_request_is_refused(guarded):
    answer = httpx.get(f"http://127.0.0.1:{guarded.port}/")
    assert answer.status_code == 403


def test_wrong_secret_is_refused(guarded):
    answer = httpx.get(
        f"http://127.0.0.1:{guarded.port}/", headers={SECRET_HEADER: "guess"}
    )
    assert answer.status_code == 403


def test_the_gateways_secret_opens_the_page(guarded):
    answer = httpx.get(
        f"http://127.0.0.1:{guarded.port}/", headers={SECRET_HEADER: guarded.secret}
    )
    assert answer.status_code == 200
    assert "text/html" in answer.headers["content-type"]


def test_direct_websocket_is_refused(guarded):
    async def open_it():
        async with connect(
            f"ws://127.0.0.1:{guarded.port}/",
            subprotocols=[f"viser-v{viser.__version__}"],
        ):
            pass

    with pytest.raises(websockets.exceptions.InvalidStatus, match="403"):
        asyncio.run(open_it())


def test_nobody_handles_a_request_for_a_public_tunnel(guarded):
    handlers = guarded.server._websock_server._incoming_handlers
    assert not [kind for kind in handlers if kind.__name__.startswith("ShareUrl")]
