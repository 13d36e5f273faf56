"""The AsyncAPI document describes the frames that the streams really send."""

import json

import jsonschema
import msgspec
import pytest

from station.api import asyncapi
from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.api.streams.topics import topic_names
from station.client import StationClient
from station.core.control.switching import SwitchRequest
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.test_server import open_stream
from tests.franka_station import make_franka_station
from tests.waiting import PATIENCE

DOCUMENT = asyncapi.document()
CYCLED = sorted(set(DOCUMENT["channels"]) - {"events", "command"})


@pytest.fixture
def arm():
    """Serve an arm whose controller `arm` runs."""
    station = make_franka_station(
        objects=[{"name": "cube", "type": "box", "size": [0.1] * 3}]
    )
    station.switch_controllers(SwitchRequest(["arm"]))
    station.loop.step(5)
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with ApiServer(app, port=0) as server:
        yield station, server


def check(message, frame):
    payload = DOCUMENT["components"]["messages"][message]["payload"]
    schema = {**payload, "components": DOCUMENT["components"]}
    jsonschema.Draft202012Validator(schema).validate(frame)


def frames(arm, topic, query):
    station, server = arm
    with open_stream(server, topic, query=query) as stream:
        hello = stream.recv(timeout=PATIENCE)
        station.loop.step(30)
        return hello, stream.recv(timeout=PATIENCE)


def test_every_topic_is_described(arm):
    station, _ = arm
    kinds = {name.partition("/")[0] for name in topic_names(station)}

    assert kinds | {"command"} == set(DOCUMENT["channels"])


def test_the_frame_of_an_event_is_as_described(arm):
    _, server = arm
    with open_stream(server, "events") as stream:
        hello = stream.recv(timeout=PATIENCE)
        with StationClient(server.url, OPERATOR) as client:
            client.stop("now")
        frame = stream.recv(timeout=PATIENCE)

    check("hello", json.loads(hello))
    check("events_state", json.loads(frame))


@pytest.mark.parametrize("form", ["state", "cycles"])
@pytest.mark.parametrize(
    "name", sorted(set(DOCUMENT["channels"]) - {"events", "command"})
)
def test_recorded_frames_are_as_described(arm, name, form):
    members = {"controller_state": "/arm", "robot_state": "/panda"}
    query = "?rate=100" if form == "state" else "?rate=full"

    hello, frame = frames(arm, name + members.get(name, ""), query)

    check("hello", json.loads(hello))
    check(f"{name}_{form}", json.loads(frame))


def test_a_frame_in_msgpack_is_the_same(arm):
    _, frame = frames(arm, "joint_states", "?rate=full&format=msgpack")

    check("joint_states_cycles", msgspec.msgpack.decode(frame))


def test_a_frame_of_another_form_does_not_fit(arm):
    _, frame = frames(arm, "joint_states", "?rate=full")

    with pytest.raises(jsonschema.ValidationError):
        check("joint_states_state", json.loads(frame))


def test_all_references_exist_and_every_property_is_described():
    schemas = DOCUMENT["components"]["schemas"]
    parts = json.dumps(DOCUMENT).split('"#/components/schemas/')[1:]
    assert {part.partition('"')[0] for part in parts} <= set(schemas)
    missing = [
        f"{name}.{key}"
        for name, schema in schemas.items()
        for key, found in schema.get("properties", {}).items()
        if "description" not in found
    ]
    assert missing == []


def test_the_document_needs_no_token(http):
    assert http.get("/api/v1/asyncapi.json").json() == DOCUMENT
