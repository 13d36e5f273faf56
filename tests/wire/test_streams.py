"""Wire models of streams."""

from station.wire import StreamFrame


def test_a_frame_needs_no_boot_id():
    frame = StreamFrame.model_validate_json(
        '{"topic": "t", "seq": 1, "epoch": 2, "stamp": 0.5, "data": {"a": [null, 1]}}'
    )

    assert frame.boot_id == ""
    assert frame.data == {"a": [None, 1]}
