"""Loading, unloading and switching: patience and keys of the requests."""

import asyncio

import httpx
import pytest

from station import wire
from station.client._async.connection import AsyncConnection
from station.client._async.controller_changes import load, switch, unload
from station.client.errors import StationUnreachableError
from station.client.routes import KEY_HEADER
from station.wire.controllers import LOAD_TIMEOUT


class Refusing(httpx.AsyncBaseTransport):
    """Keeps each request and answers that nothing is there."""

    def __init__(self):
        self.requests = []

    async def handle_async_request(self, request):
        self.requests.append(request)
        raise httpx.ConnectError("nobody is there")


def asked(change, *arguments):
    """Return the request that a change sends."""
    transport = Refusing()

    async def run():
        connection = AsyncConnection("http://a", "t", 10.0, transport)
        await change(connection, *arguments)

    with pytest.raises(StationUnreachableError, match="nobody is there"):
        asyncio.run(run())
    return transport.requests[0]


@pytest.mark.parametrize(
    ("change", "argument", "patience"),
    [
        (load, wire.LoadRequest(name="a"), LOAD_TIMEOUT),
        (load, wire.LoadRequest(name="a", timeout=5.0), 5.0),
        (unload, "a", 0.0),
        (switch, wire.SwitchRequest(start=["a"], bound=7.0), 7.0),
        (switch, wire.SwitchRequest(start=["a"], timeout=3.0), 3.0),
        (switch, wire.SwitchRequest(start=["a"], bound=None), None),
    ],
)
def test_a_change_waits_as_long_as_it_may_take(change, argument, patience):
    request = asked(change, argument, None)

    expected = None if patience is None else 10.0 + patience
    assert request.extensions["timeout"]["read"] == expected
    assert KEY_HEADER not in request.headers


@pytest.mark.parametrize(
    ("change", "argument"),
    [
        (load, wire.LoadRequest(name="a")),
        (unload, "a"),
        (switch, wire.SwitchRequest(start=["a"])),
    ],
)
def test_a_key_goes_with_the_request(change, argument):
    assert asked(change, argument, "mine").headers[KEY_HEADER] == "mine"
