"""What a scan of a file finds, and how far it reads."""

import io
import struct
import tracemalloc

import lz4.frame

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


def test_a_chunk_that_grows_without_end_is_damaged():
    """A small chunk may expand to any size; no more is made than it says."""
    packed = lz4.frame.compress(bytes(50_000_000))
    body = struct.pack("<QQQI", 1, 2, 100, 0) + struct.pack("<I", 3) + b"lz4"
    body += struct.pack("<Q", len(packed)) + packed
    data = (
        MAGIC + struct.pack("<BQ", 6, len(body)) + body + struct.pack("<BQI", 15, 4, 0)
    )
    tracemalloc.start()

    content = McapScan(io.BytesIO(data), lambda: None).run()

    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()
    assert content.chunks == []
    assert [(one.begin, one.end) for one in content.spans] == [(8, len(data) - 13)]
