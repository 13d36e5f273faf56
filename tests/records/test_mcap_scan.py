"""What a scan of a file finds, and how far it reads."""

import io

from station.records.mcap_scan import MAGIC, McapScan


def test_a_length_that_no_file_has_is_not_read():
    """A damaged length must cost neither memory nor time."""
    data = MAGIC + b"\x06" + b"\xff" * 8 + bytes(100)

    content = McapScan(io.BytesIO(data), lambda: None).run()

    assert (content.end, content.is_whole, content.chunks) == (len(MAGIC), False, [])


def test_the_scan_pauses_between_records(station, recorder, store):
    recorder.start("x")
    for _ in range(5):
        station.loop.step(10)
        recorder.drain()
        recorder._recording.write_out(end_chunk=True)
    path = store.file(recorder.stop().identifier)
    paused = []

    with path.open("rb") as file:
        content = McapScan(file, lambda: paused.append(0)).run()

    assert content.is_whole
    assert len(paused) > len(content.chunks) >= 5
