"""Pages and frames on their way between a browser and Viser."""

import asyncio
from functools import partial

import httpx
import msgspec
import pytest
import viser
from starlette.applications import Starlette
from starlette.responses import Response
from starlette.routing import Route, WebSocketRoute
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.ui.gateway.viser_relay import ViserRelay
from station.ui.sessions.sessions import Role, Sessions
from tests.ui.bench import CAMERA
from tests.ui.served import Served
from tests.waiting import PATIENCE


@pytest.fixture
def relayed(shared_bench):
    """Addresses at which an operator and a viewer reach the bench's Viser."""
    door = shared_bench.guarded
    relay = ViserRelay(door.port, door.secret)
    routes = [WebSocketRoute(f"/{role.value}", _as(relay, role)) for role in Role]
    with Served(Starlette(routes=routes)) as served:
        yield served.url.replace("http", "ws")


def _as(relay, role):
    async def endpoint(socket):
        await relay.socket(socket, role.value, lambda: role, asyncio.Event().wait)

    return endpoint


def _connect(url, version=viser.__version__):
    return connect(url, subprotocols=[f"viser-v{version}"], max_size=None, proxy=None)


def _value(slider, value):
    return msgspec.msgpack.encode({
        "type": "GuiUpdateMessage",
        "uuid": slider._impl.uuid,
        "updates": {"value": value},
    })


@pytest.fixture
def slider(shared_bench):
    slider = shared_bench.guarded.server.gui.add_slider("s", 0.0, 1.0, 0.1, 0.0)
    yield slider
    slider.remove()


def test_an_operators_values_arrive(shared_bench, relayed, slider):
    with _connect(f"{relayed}/operator") as socket:
        socket.send(msgspec.msgpack.encode(CAMERA))
        socket.send(_value(slider, 0.5))
        assert shared_bench.wait(lambda: slider.value == 0.5)


def test_a_viewer_sees_the_scene_but_its_values_do_not_arrive(
    shared_bench, relayed, slider
):
    with _connect(f"{relayed}/operator") as operator:
        operator.send(msgspec.msgpack.encode(CAMERA))
        with _connect(f"{relayed}/viewer") as viewer:
            assert isinstance(viewer.recv(timeout=PATIENCE), bytes)
            viewer.send(_value(slider, 0.9))
            # Sent after it: when this has arrived, the other would have, too.
            operator.send(_value(slider, 0.3))
            assert shared_bench.wait(lambda: slider.value != 0.0)
            assert slider.value == 0.3


def test_visers_close_code_reaches_the_browser(relayed):
    with (
        _connect(f"{relayed}/operator", version="0.0.0") as socket,
        pytest.raises(ConnectionClosed) as closed,
    ):
        socket.recv(timeout=PATIENCE)
    assert closed.value.rcvd.code == 1002
    assert "Version mismatch" in closed.value.rcvd.reason


def test_the_socket_is_closed_when_its_session_ends(shared_bench):
    door = shared_bench.guarded
    relay, sessions = ViserRelay(door.port, door.secret), Sessions()
    opened = []

    async def watch(socket):
        opened.append(sessions.open(Role.OPERATOR))
        end = partial(sessions.wait_for_end, opened[0])
        await relay.socket(socket, "key", lambda: Role.OPERATOR, end)

    async def log_out(_):
        sessions.close(opened[0].identifier)
        return Response()

    routes = [WebSocketRoute("/ui", watch), Route("/logout", log_out)]
    with (
        Served(Starlette(routes=routes)) as served,
        _connect(f"{served.url.replace('http', 'ws')}/ui") as socket,
    ):
        socket.send(msgspec.msgpack.encode(CAMERA))
        assert isinstance(socket.recv(timeout=PATIENCE), bytes)
        httpx.get(f"{served.url}/logout")
        with pytest.raises(ConnectionClosed) as closed:
            _read_to_the_end(socket)

    assert closed.value.rcvd.code == 4401


def _read_to_the_end(socket):
    while True:
        socket.recv(timeout=PATIENCE)


def test_the_page_comes_with_visers_secret(shared_bench):
    async def fetch(port, secret):
        relay = ViserRelay(port, secret)
        try:
            return await relay.page()
        finally:
            await relay.close()

    door = shared_bench.guarded
    assert asyncio.run(fetch(door.port, door.secret)).status_code == 200
    assert asyncio.run(fetch(door.port, "guess")).status_code == 502
    assert asyncio.run(fetch(9, "guess")).status_code == 502
