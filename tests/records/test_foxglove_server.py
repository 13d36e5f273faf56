"""The Foxglove server, asked by a plain WebSocket client in the words of its protocol.

Source: https://github.com/foxglove/ws-protocol, docs/spec.md.
"""

import json
import struct

import pytest
from websockets.sync.client import connect

from station.core.control.switching import SwitchRequest
from station.core.description.urdf_parser import parse_urdf
from station.records import messages
from station.records.foxglove_server import FoxgloveServer
from tests.api.spring import make_station

URDF = """<robot name="r"><link name="base"/><link name="tip"/>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/>
<origin xyz="0 0 1"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""


@pytest.fixture
def station():
    """Return a station whose controller runs."""
    station = make_station()
    station.load_controller("arm", "test/Spring", {"joint": "j", "k": 2.0})
    station.switch_controllers(SwitchRequest(start=["arm"]))
    station.loop.step(2)
    return station


@pytest.fixture
def client(station):
    """Return a client of the station's server, which sends when the tests say so."""
    texts = {"/robot_description": URDF}
    server = FoxgloveServer(
        station, host="127.0.0.1", port=0, urdf=parse_urdf(URDF), texts=texts
    )
    server.send()
    url = f"ws://127.0.0.1:{server.port}"
    with connect(url, subprotocols=["foxglove.sdk.v1"]) as client:
        yield client
    server.close()


def _until(client, op):
    """Return the next message of a kind; others are skipped."""
    while True:
        found = client.recv(timeout=5.0)
        if isinstance(found, str) and json.loads(found)["op"] == op:
            return json.loads(found)


def _channels(client, wanted):
    """Return the channels that the server advertises, by topic."""
    found = {}
    while not wanted <= found.keys():
        for one in _until(client, "advertise")["channels"]:
            found[one["topic"]] = one
    return found


def test_channels_are_advertised_and_sent(client, station):
    kinds = {
        "/joint_states": messages.JOINT_STATE,
        "/tf": messages.TF_MESSAGE,
        "/controllers/arm": messages.CONTROLLER_STATE,
    }
    channels = _channels(client, kinds.keys() | {"/robot_description"})
    for number, (topic, kind) in enumerate(kinds.items()):
        assert channels[topic]["schema"] == kind.text
        subscription = {"id": number, "channelId": channels[topic]["id"]}
        asked = {"op": "subscribe", "subscriptions": [subscription]}
        client.send(json.dumps(asked))
    found = {}
    while len(found) < len(kinds):
        station.loop.step()
        try:
            data = client.recv(timeout=0.1)
        except TimeoutError:
            continue  # the subscription was not there yet; the next cycle is sent
        if isinstance(data, bytes) and data[0] == 1:
            number, _ = struct.unpack_from("<IQ", data, 1)
            topic = list(kinds)[number]
            found[topic] = kinds[topic].decode(data[13:])

    assert found["/joint_states"]["position"] == [0.25]
    assert found["/controllers/arm"]["name"] == ["j"]
    (transform,) = found["/tf"]["transforms"]
    assert transform["header"]["frame_id"] == "base"
    assert transform["transform"]["translation"] == {"x": 0.0, "y": 0.0, "z": 1.0}
    assert transform["transform"]["rotation"]["z"] == pytest.approx(0.1246747334)


def test_parameters_are_the_gains(client, station):
    client.send(json.dumps({"op": "getParameters", "parameterNames": [], "id": "a"}))
    (found,) = _until(client, "parameterValues")["parameters"]
    assert (found["name"], found["value"]) == ("arm/k", 2.0)

    wanted = [{"name": "arm/k", "value": 3.5}]
    client.send(json.dumps({"op": "setParameters", "parameters": wanted, "id": "b"}))

    (found,) = _until(client, "parameterValues")["parameters"]
    assert found["value"] == 3.5
    assert station.gains("arm").values == {"k": 3.5}


@pytest.mark.parametrize(
    ("request_", "ok"), [({"stop": ["arm"]}, True), ({"stop": ["nobody"]}, False)]
)
def test_controllers_are_switched(client, station, request_, ok):
    (service,) = _until(client, "advertiseServices")["services"]
    assert service["name"] == "/switch_controllers"
    body = json.dumps(request_).encode()
    head = struct.pack("<BIII", 2, service["id"], 1, len(b"json"))
    client.send(head + b"json" + body)
    while True:
        answer = client.recv(timeout=5.0)
        if isinstance(answer, bytes) and answer[0] == 3:
            break

    assert json.loads(answer[13 + 4 :])["ok"] is ok
    running = [
        one.name for one in station.controllers() if one.state.value == "running"
    ]
    assert running == ([] if ok else ["arm"])
