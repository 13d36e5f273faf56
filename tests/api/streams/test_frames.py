"""How frames are written."""

import json
import math

import msgspec
import pytest

from station.api.streams.frames import encode
from station.api.streams.topics import Payload

PAYLOAD = Payload(7, 2, 0.5, {"name": ["j"], "position": [0.25], "effort": [math.nan]})
BATCH = Payload(
    9,
    2,
    0.5,
    {
        "name": ["j"],
        "samples": [{"cycle": 8, "stamp": 0.1, "position": [1.0]}],
        "lost": 3,
    },
)


def test_json_has_the_five_keys_and_null_for_what_is_not_finite():
    frame = encode("t", PAYLOAD, seq=3, format="json")

    assert frame.seq == 3
    assert json.loads(frame.text) == {
        "topic": "t",
        "seq": 3,
        "epoch": 2,
        "stamp": 0.5,
        "data": {"name": ["j"], "position": [0.25], "effort": [None]},
    }


def test_msgpack_says_the_same():
    frame = encode("t", BATCH, seq=3, format="msgpack", boot_id="b")

    assert frame.text is None
    message = msgspec.msgpack.decode(frame.binary)
    assert message["data"] == BATCH.data
    assert message["boot_id"] == "b"


@pytest.mark.parametrize(
    ("payload", "fields", "data"),
    [
        (PAYLOAD, {"position"}, {"position": [0.25]}),
        (PAYLOAD, {"name", "position"}, {"name": ["j"], "position": [0.25]}),
        (
            BATCH,
            {"position"},
            {"samples": [{"cycle": 8, "position": [1.0]}], "lost": 3},
        ),
        (
            BATCH,
            {"name", "stamp"},
            {"name": ["j"], "samples": [{"cycle": 8, "stamp": 0.1}], "lost": 3},
        ),
    ],
)
def test_fields_choose_keys(payload, fields, data):
    frame = encode("t", payload, seq=1, format="json", fields=frozenset(fields))

    assert json.loads(frame.text)["data"] == data
