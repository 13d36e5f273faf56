"""A port of Foxglove, served beside the API."""

import asyncio

import pytest

from station.api.foxglove.foxglove_port import FoxglovePort
from station.api.foxglove.live_channels import LiveChannels
from station.api.server import ApiServer
from station.api.tool_port import Place
from station.core.control.switching import SwitchRequest
from station.core.description.urdf_parser import parse_urdf
from station.web.host_policy import HostPolicy
from tests.api.foxglove.words import URDF


@pytest.fixture
def station(station):
    """Return a station whose controller runs, and whose loop goes on."""
    station.load_controller("arm", "test/Spring", {"joint": "j", "k": 2.0})
    station.switch_controllers(SwitchRequest(start=["arm"]))
    station.loop.step(2)
    return station


@pytest.fixture
def serve(app, station):
    """Return what serves a port of Foxglove; both addresses in the answer."""
    servers = []

    def serve(*, anonymous=True, policy=None):
        port = FoxglovePort(
            app,
            LiveChannels(station, parse_urdf(URDF), {"/robot_description": URDF}),
            Place("127.0.0.1", 0, policy or HostPolicy(), anonymous),
        )
        server = ApiServer(app, "127.0.0.1", 0, ports=[port])
        server.start()
        servers.append(server)
        return server.url, f"ws://127.0.0.1:{port.port}/"

    yield serve
    for server in servers:
        server.stop()


@pytest.fixture
def made_token(authenticator):
    """Return the secret of a named operator's token."""
    return asyncio.run(authenticator.named.create("ana", "operator", None))
