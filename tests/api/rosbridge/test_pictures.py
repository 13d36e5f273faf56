"""Pictures of cameras as messages of ROS."""

import base64
import re
import sys

import pytest

from station.api.app import create_app
from station.api.cameras import Cameras
from tests.api.test_cameras import CELL, DRAWS

TOPIC = "/cell/image_raw/compressed"


@pytest.fixture
def app(station, authenticator):
    """Return an app with a camera."""
    command = (sys.executable, "-c", DRAWS)
    cameras = Cameras({"cell": CELL}, lambda: {"url": "here"}, command)
    yield create_app(station, authenticator, cameras=cameras)
    cameras.close()


def test_a_picture_is_a_compressed_image(client):
    message = client.subscribe(TOPIC, type="sensor_msgs/CompressedImage")["msg"]
    again = client.until("publish", topic=TOPIC)["msg"]

    assert message["format"] == "jpeg"
    assert message["header"]["frame_id"] == "world"
    assert re.match(rb"cell \d+ here", base64.b64decode(message["data"]))
    assert again["header"]["stamp"] != message["header"]["stamp"]


@pytest.mark.parametrize(
    ("compression", "kind"),
    [
        ("cbor", "sensor_msgs/CompressedImage"),
        ("cbor-raw", "sensor_msgs/CompressedImage"),
        ("cbor-raw", "sensor_msgs/msg/CompressedImage"),
    ],
)
def test_bytes_stay_bytes_where_the_form_has_them(client, compression, kind):
    client.send("subscribe", topic=TOPIC, type=kind, compression=compression)

    assert b"jpeg" in (found := client.until("publish"))
    assert re.search(rb"cell \d+ here", found)


def test_topics_of_cameras_are_listed(client):
    found = client.values(
        "/rosapi/topics_for_type", {"type": "sensor_msgs/CompressedImage"}
    )

    assert found["topics"] == [TOPIC]
