"""Messages as JSON, pictures, fragments and CBOR."""

import base64
import io
import json
import struct

import pytest
from PIL import Image

from station.api.rosbridge.outbox import Form, Publication, cbor, png, text_frames
from station.api.rosbridge.ros_types import checked, serialized

STATE = checked("sensor_msgs/JointState", {"name": ["j"], "position": [0.5, -2.0]})


def payloads(frames):
    """Return the payloads of WebSocket frames that are not masked."""
    found = []
    while frames:
        size, start = frames[1], 2
        if size == 126:
            size, start = struct.unpack(">H", frames[2:4])[0], 4
        elif size == 127:
            size, start = struct.unpack(">Q", frames[2:10])[0], 10
        found.append(frames[start : start + size])
        frames = frames[start + size :]
    return found


def published(form):
    return payloads(Publication("/t", "sensor_msgs/JointState", STATE, 5).frames(form))


# RFC 8949, appendix A.
@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0, "00"), (23, "17"), (24, "1818"), (100, "1864"), (1000, "1903e8"),
        (1000000, "1a000f4240"), (1000000000000, "1b000000e8d4a51000"),
        (-1, "20"), (-1000, "3903e7"), (1.1, "fb3ff199999999999a"),
        (False, "f4"), (True, "f5"), (None, "f6"), ("", "60"), ("IETF", "6449455446"),
        ("\u00fc", "62c3bc"), (b"\x01\x02\x03\x04", "4401020304"), ([], "80"),
        ([1, [2, 3], [4, 5]], "8301820203820405"),
        ({"a": 1, "b": [2, 3]}, "a26161016162820203"),
    ],
)  # fmt: skip
def test_cbor_is_that_of_the_standard(value, expected):
    assert cbor(value).hex() == expected


def test_arrays_of_numbers_are_typed_in_cbor():
    (data,) = published(Form("cbor"))
    # RFC 8746: tag 86 is an array of float64 in little-endian order.
    assert b"\x68position\xd8\x56\x50" + struct.pack("<2d", 0.5, -2.0) in data
    assert data.startswith(
        cbor({"op": "publish", "topic": "/t"})[1:].join([b"\xa3", b""])
    )


@pytest.mark.parametrize("is_ros2", [True, False])
def test_raw_cbor_carries_the_message_as_ros_sends_it(is_ros2):
    (data,) = published(Form("cbor-raw", is_ros2=is_ros2))
    raw = serialized("sensor_msgs/JointState", STATE, ros2=is_ros2)
    assert data.endswith(cbor({"secs": 0, "nsecs": 5, "bytes": raw}))


@pytest.mark.parametrize("size", [1, 2, 3, 4, 50, 1000])
def test_a_picture_has_the_data_as_its_pixels(size):
    data = bytes(1 + k % 250 for k in range(size))
    picture = Image.open(io.BytesIO(png(data)))
    assert picture.mode == "RGB"
    pixels = picture.tobytes()
    assert pixels[:size] == data
    assert set(pixels[size:]) <= {10}


def test_a_picture_is_sent_as_base64():
    (frame,) = published(Form("png"))
    message = json.loads(frame)
    assert message["op"] == "png"
    pixels = Image.open(io.BytesIO(base64.b64decode(message["data"]))).tobytes()
    assert json.loads(pixels) == json.loads(published(Form())[0])


def test_a_long_message_comes_in_fragments():
    whole = {"op": "x", "data": "\u00e4" * 300}
    parts = [
        json.loads(p) for p in payloads(text_frames(whole, Form(fragment_size=100)))
    ]
    assert all(len(part["data"]) <= 100 for part in parts)
    assert [part["num"] for part in parts] == list(range(parts[0]["total"]))
    assert json.loads("".join(part["data"] for part in parts)) == whole


def test_numbers_that_are_not_finite_are_null():
    (frame,) = payloads(text_frames({"value": float("nan")}, Form()))
    assert json.loads(frame) == {"value": None}
