"""CDR against an independent decoder, and layouts against the general encoder."""

from array import array

import pytest
from mcap_ros2._dynamic import generate_dynamic

from station.records import messages
from station.records.cdr import Layout, MessageType


def _doubles(values):
    return array("d", values).tobytes()


@pytest.mark.parametrize("names", [[], ["a"], ["panda_joint1", "x", "panda_finger"]])
def test_a_layout_is_what_an_independent_decoder_reads(names):
    size = len(names)
    layout = Layout(
        messages.JOINT_STATE,
        {"name": names, "frame_id": "base"},
        dict.fromkeys(("position", "velocity", "effort"), size),
    )
    columns = [[k + 0.25 * i for i in range(size)] for k in (1.0, 2.0, 3.0)]

    data = layout.pack(7, 9, *map(_doubles, columns))

    kind = messages.JOINT_STATE
    read = generate_dynamic(kind.name, kind.text)[kind.name](data)
    assert (read.header.stamp.sec, read.header.stamp.nanosec) == (7, 9)
    assert read.header.frame_id == "base"
    assert list(read.name) == names
    assert [list(read.position), list(read.velocity), list(read.effort)] == columns


@pytest.mark.parametrize("mode", ["", "move", "user_stopped"])
def test_the_general_encoder_is_what_an_independent_decoder_reads(mode):
    kind = messages.CYCLE
    message = {
        "header": messages.header(1_500_000_000),
        "cycle": 2**40,
        "epoch": 3,
        "time": 1.5,
        "period": 0.001,
        "mode": mode,
    }

    data = kind.encode(message)

    read = generate_dynamic(kind.name, kind.text)[kind.name](data)
    assert (read.cycle, read.epoch, read.period, read.mode) == (2**40, 3, 0.001, mode)
    assert kind.decode(data) == message


def test_layout_and_general_encoder_agree():
    kind = MessageType("a/msg/B", "uint8 few\nfloat64[] many\nstring text\nbool last\n")
    layout = Layout(kind, {"text": "abc"}, {"many": 2})

    packed = layout.pack(3, _doubles([1.0, 2.0]), 1)

    message = {"few": 3, "many": [1.0, 2.0], "text": "abc", "last": True}
    assert packed == kind.encode(message)


def test_a_line_that_is_no_field_is_refused():
    with pytest.raises(ValueError, match="is no field"):
        MessageType("a/msg/B", "float64")


def test_an_array_of_another_length_is_refused():
    kind = MessageType("a/msg/B", "float64[3] three\n")
    with pytest.raises(ValueError, match="2 elements"):
        kind.encode({"three": [1.0, 2.0]})
