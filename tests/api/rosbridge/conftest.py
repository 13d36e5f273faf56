"""A port of rosbridge over a station whose loop runs, and a client of its protocol."""

import json

import pytest
from websockets.sync.client import connect

from station.api.app import create_app
from station.api.rosbridge.rosbridge_port import RosbridgePort
from station.api.server import ApiServer
from station.api.tool_port import Place
from station.app.composition import compose
from station.config import load_config
from station.core.description.urdf_parser import parse_urdf
from station.web.host_policy import HostPolicy
from tests.api.conftest import OPERATOR
from tests.waiting import PATIENCE

JOINTS = ["joint1", "joint2"]
_JOINT = """<link name="{0}"/><joint name="{0}" type="revolute">
<parent link="{1}"/><child link="{0}"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" velocity="2" effort="50"/></joint>"""
DESCRIPTION = f"""<robot name="r"><link name="base"/>
{_JOINT.format("joint1", "base")}{_JOINT.format("joint2", "joint1")}</robot>"""
CONTROLLERS = {
    "joint_state_controller": {
        "type": "joint_state_controller/JointStateController",
        "publish_rate": 50,
    },
    "pose": {
        "type": "position_controllers/JointGroupPositionController",
        "joints": JOINTS,
    },
    "single": {
        "type": "effort_controllers/JointPositionController",
        "joint": "joint1",
        "pid": {"p": 10.0, "i": 0.0, "d": 1.0},
    },
    "arm": {
        "type": "position_controllers/JointTrajectoryController",
        "joints": JOINTS,
        # After a pause of the machine the joints jump, and come to rest a cycle later.
        "constraints": {"goal_time": 5.0},
    },
}


class RosClient:
    """Speaks rosbridge over one connection."""

    def __init__(self, url, **options):
        # Python 3.11 cannot let two threads wait for the end of a third one, which the
        # thread of pings and `close` may do.
        self.socket = connect(url, ping_interval=None, **options)
        self.statuses = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def send(self, op, **message):
        """Send an operation."""
        self.socket.send(json.dumps({"op": op, **message}))

    def until(self, op, **facts):
        """Return the next message of an operation; statuses on the way are kept."""
        while True:
            message = self.socket.recv(timeout=PATIENCE)
            if isinstance(message, bytes):
                return message
            found = json.loads(message)
            if found["op"] == "status":
                self.statuses.append(found)
            if found["op"] == op and facts.items() <= found.items():
                return found

    def call(self, service, args=None, **more):
        """Return the response of a service."""
        self.send("call_service", service=service, args=args, id="c", **more)
        return self.until("service_response", service=service)

    def values(self, service, args=None):
        """Return the values of a service that must succeed."""
        found = self.call(service, args)
        assert found["result"], found
        return found["values"]

    def switch(self, start=(), stop=()):
        """Switch controllers."""
        return self.values(
            "/controller_manager/switch_controller",
            {
                "start_controllers": list(start),
                "stop_controllers": list(stop),
                "strictness": 2,
            },
        )["ok"]

    def subscribe(self, topic, **more):
        """Subscribe and return the first message."""
        self.send("subscribe", topic=topic, **more)
        return self.until("publish", topic=topic)


@pytest.fixture
def station():
    """Return a station of two joints whose loop runs."""
    config = load_config({"robot": {"type": "mock_hw/MockRobotHW", "joints": JOINTS}})
    station = compose(config).station
    station.parameters.set("robot_description", DESCRIPTION)
    for name, params in CONTROLLERS.items():
        station.load_controller(name, None, params)
    station.loop.start()
    yield station
    station.loop.stop()
    station.loop.hw.close()


@pytest.fixture
def app(station, authenticator):
    """Return the app over the station."""
    return create_app(station, authenticator)


@pytest.fixture
def serve(app):
    """Return what serves a port of rosbridge; both addresses in the answer."""
    servers = []

    def serve(*, anonymous=True, policy=None):
        port = RosbridgePort(
            app,
            parse_urdf(DESCRIPTION),
            {"/robot_description": DESCRIPTION},
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
def client(serve):
    """Return an operator's client."""
    _, url = serve()
    with RosClient(f"{url}?token={OPERATOR}") as client:
        yield client
