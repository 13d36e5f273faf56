"""A Foxglove client, asked and answered in the words of its protocol.

Source: https://github.com/foxglove/ws-protocol, docs/spec.md.
"""

import json
import struct
from urllib.parse import urlencode

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.client import StationClient
from station.events import EventKind
from station.records import messages
from tests.api.conftest import OPERATOR
from tests.api.foxglove.words import (
    PROTOCOLS,
    URDF,
    call,
    running,
    set_gains,
    subscribe,
    until,
)
from tests.waiting import PATIENCE


@pytest.fixture
def open_client(serve):
    """Return what connects to the port."""
    _, address = serve()
    clients = []

    def open_client(protocol="foxglove.sdk.v1", **query):
        url = f"{address}?{urlencode(query)}"
        client = connect(url, subprotocols=[protocol])
        clients.append(client)
        return client

    yield open_client
    for client in clients:
        client.close()


@pytest.fixture
def client(open_client):
    """Return the client of an operator."""
    return open_client(token=OPERATOR)


@pytest.mark.parametrize("protocol", ["foxglove.sdk.v1", "foxglove.websocket.v1"])
def test_channels_are_advertised_and_sent(open_client, station, protocol):
    kinds = {
        "/joint_states": messages.JOINT_STATE,
        "/tf": messages.TF_MESSAGE,
        "/controllers/arm": messages.CONTROLLER_STATE,
        "/robot_description": messages.STRING,
    }
    client = open_client(protocol)  # whoever is on this machine may look
    channels = subscribe(client, *kinds)
    assert all(channels[topic]["schema"] == kind.text for topic, kind in kinds.items())
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

    assert client.subprotocol == protocol
    assert found["/joint_states"]["position"] == [0.25]
    assert found["/controllers/arm"]["name"] == ["j"]
    assert found["/robot_description"]["data"] == URDF
    (transform,) = found["/tf"]["transforms"]
    assert transform["header"]["frame_id"] == "base"
    assert transform["transform"]["translation"] == {"x": 0.0, "y": 0.0, "z": 1.0}
    assert transform["transform"]["rotation"]["z"] == pytest.approx(0.1246747334)


def test_parameters_are_the_gains(client, station):
    client.send(json.dumps({"op": "getParameters", "parameterNames": [], "id": "a"}))
    answer = until(client, "parameterValues")
    assert answer["id"] == "a"
    (found,) = answer["parameters"]
    assert (found["name"], found["value"]) == ("arm/k", 2.0)

    (answer,) = set_gains(client, k=3.5)

    assert answer["parameters"][0]["value"] == 3.5
    assert station.tuning.gains("arm").values == {"k": 3.5}


def test_a_refused_parameter_is_told_and_the_good_ones_are_set(client, station):
    station.load_controller("leg", "test/Spring", {"joint": "j", "k": 1.0})
    wanted = {"arm/k": 99.0, "leg/k": 5.0, "arm/q": 1.0, "leg/k2": "text"}
    parameters = [{"name": name, "value": value} for name, value in wanted.items()]
    client.send(json.dumps({"op": "setParameters", "parameters": parameters}))

    told = [until(client, "status")["message"] for _ in range(3)]
    answer = until(client, "parameterValues")["parameters"]

    assert "There is no gain 'arm/q'." in told[0]
    assert "There is no gain 'leg/k2'." in told[1]
    assert "99" in told[2]
    assert {one["name"]: one["value"] for one in answer} == {"arm/k": 2.0, "leg/k": 5.0}
    assert station.tuning.gains("leg").values == {"k": 5.0}


def test_a_number_beyond_all_doubles_is_refused(client, station):
    client.send(
        '{"op": "setParameters", "parameters": [{"name": "arm/k", "value": 1%s}]}'
        % ("0" * 400)
    )
    assert "The gain 'arm/k' cannot be 1000" in until(client, "status")["message"]
    assert station.tuning.gains("arm").values == {"k": 2.0}


def test_a_fault_of_the_station_is_not_the_clients(
    client, station, monkeypatch, caplog
):
    def fail(*_):
        raise KeyError("lost")

    with monkeypatch.context() as broken:
        broken.setattr(type(station.tuning), "all_gains", fail)
        client.send(json.dumps({"op": "getParameters", "parameterNames": []}))
        told = until(client, "status")["message"]
    assert "The station failed unexpectedly: KeyError" in told
    assert "lost" in caplog.text
    client.send(json.dumps({"op": "getParameters", "parameterNames": []}))
    assert until(client, "parameterValues")["parameters"]


def test_a_gain_that_somebody_else_changes_is_sent_to_who_subscribed(client, station):
    asked = {"op": "subscribeParameterUpdates", "parameterNames": ["arm/k"]}
    client.send(json.dumps(asked))
    client.send(json.dumps({"op": "getParameters", "parameterNames": [], "id": "a"}))
    until(client, "parameterValues")
    station.tuning.set_gains("arm", {"k": 4.0})

    (found,) = until(client, "parameterValues")["parameters"]
    assert (found["name"], found["value"]) == ("arm/k", 4.0)


def test_controllers_are_switched(client, station):
    service = until(client, "advertiseServices")["services"][0]
    assert service["name"] == "/switch_controllers"
    call(client, json.dumps({"stop": ["arm"]}).encode(), service["id"])
    while (
        not isinstance(answer := client.recv(timeout=PATIENCE), bytes) or answer[0] != 3
    ):
        pass

    assert json.loads(answer[13 + 4 :])["ok"] is True
    assert running(station) == []


@pytest.mark.parametrize(
    ("payload", "service", "told"),
    [
        (b'{"stop": ["nobody"]}', 1, "nobody"),
        (b'{"start": "arm"}', 1, "is no list of names"),
        (b"no JSON", 1, "Expecting value"),
        (b'{"stop": [], "stop": ["arm"]}', 1, "has the key 'stop' twice"),
        (b"[" * 60_000, 1, ""),
        (b"{}", 9, "There is no such service"),
    ],
)
def test_a_service_that_fails_says_so(client, station, payload, service, told):
    call(client, payload, service)

    failure = until(client, "serviceCallFailure")

    assert (failure["serviceId"], failure["callId"]) == (service, 7)
    assert told in failure["message"]
    assert running(station) == ["arm"]


@pytest.mark.parametrize(
    "message",
    [
        "no JSON",
        "[]",
        '{"op": "subscribe"}',
        '{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 99}]}',
        '{"op": "setParameters", "parameters": 3}',
        '{"op": "setParameters", "parameters": ["x"]}',
        '{"op": "advertise", "channels": []}',
        '{"op": "getParameters", "op": "getParameters"}',
        b"\x02\x01",
        b"\x01\x00\x00\x00\x00 published by a client, long enough",
    ],
)
def test_what_is_no_message_of_the_protocol_is_told(client, message):
    client.send(message)
    assert until(client, "status")["message"]
    client.send(json.dumps({"op": "getParameters", "parameterNames": []}))
    assert until(client, "parameterValues")["parameters"]


@pytest.mark.parametrize("way", ["lease in the address", "named token"])
def test_who_holds_control_changes_and_the_event_says_who(
    app, serve, station, made_token, way
):
    api, foxglove = serve()
    token = made_token if way == "named token" else OPERATOR
    with StationClient(api, token) as owner:
        lease = owner.lease.take("ana", ttl=60.0)
        key = "" if way == "named token" else f"&lease={lease.lease}"
        with connect(f"{foxglove}?token={token}{key}", subprotocols=PROTOCOLS) as one:
            set_gains(one, k=3.0)
            call(one, json.dumps({"stop": ["arm"]}).encode())
            while not isinstance(answer := one.recv(timeout=PATIENCE), bytes):
                assert json.loads(answer)["op"] != "serviceCallFailure"

    assert station.tuning.gains("arm").values == {"k": 3.0}
    assert running(station) == []
    events = app.state.services.event_recorder.log.recent(0)
    found = {e.what: e for e in events if e.kind is EventKind.REQUEST}
    for what in ("foxglove setParameters arm/k", "foxglove /switch_controllers"):
        assert found[what].result == "done"
        assert found[what].who.startswith("ana")
        assert found[what].where == "127.0.0.1"
    (switch,) = [e for e in events if e.kind is EventKind.SWITCH]
    assert switch.details["stopped"] == ["arm"]


def test_refused_changes_and_wrong_tokens_leave_events(app, serve):
    _, foxglove = serve()
    with connect(foxglove, subprotocols=PROTOCOLS) as client:
        set_gains(client, k=3.0)
    with (
        connect(f"{foxglove}?token=guessed", subprotocols=PROTOCOLS) as client,
        pytest.raises(ConnectionClosed),
    ):
        client.recv(timeout=PATIENCE)

    events = app.state.services.event_recorder.log.recent(0)
    (refused,) = [e for e in events if e.kind is EventKind.REQUEST and "fox" in e.what]
    assert refused.result == "refused: change_refused"
    assert refused.who == "viewer"
    assert [e.kind for e in events].count(EventKind.LOGIN_FAILED) == 1
