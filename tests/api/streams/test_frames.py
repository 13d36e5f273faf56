"""How frames are written."""

import json
import math

import msgspec
import pytest
from websockets.frames import Opcode
from websockets.protocol import CLIENT, OPEN, Protocol

from station.api.streams.channel import encode
from station.api.streams.cycle_samples import Payload

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


def test_json_has_the_six_keys_and_null_for_what_is_not_finite():
    frame = encode("t", PAYLOAD, seq=3, format="json")

    assert frame.seq == 3
    assert json.loads(frame.message) == {
        "topic": "t",
        "seq": 3,
        "epoch": 2,
        "cycle": 7,
        "stamp": 0.5,
        "data": {"name": ["j"], "position": [0.25], "effort": [None]},
    }


def test_msgpack_says_the_same():
    frame = encode("t", BATCH, seq=3, format="msgpack", boot_id="b")

    message = msgspec.msgpack.decode(frame.message)
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

    assert json.loads(frame.message)["data"] == data


@pytest.mark.parametrize("form", ["json", "msgpack"])
@pytest.mark.parametrize("size", [1, 200, 70_000])
def test_a_websocket_client_reads_the_message_from_the_wire(form, size):
    frame = encode("t", Payload(1, 1, 0.0, {"x": "y" * size}), seq=1, format=form)

    protocol = Protocol(CLIENT, state=OPEN)
    protocol.receive_data(frame.wire)

    (received,) = protocol.events_received()
    assert received.opcode is (Opcode.TEXT if form == "json" else Opcode.BINARY)
    assert received.data == frame.message
