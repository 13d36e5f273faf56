"""Events of recordings, and the notes that people add to files that are whole."""

import pytest
from mcap.reader import NonSeekingReader, make_reader

from station.core.errors import RecordingDamagedError, RecordingRefusedError
from station.records.mcap_recovery import recover_file
from station.records.recording_events import add_note, read_events
from station.records.recording_reader import read_trajectory
from station.records.recording_table import RecordingTable


@pytest.fixture(params=[True, False], ids=["with events", "without events"])
def path(station, recorder, store, request):
    """Return the file of 400 cycles of 1 ms in several chunks."""
    recorder.start("walk")
    for number in range(40):
        station.loop.step(10)
        if request.param and number == 20:
            stamp = station.loop.time
            recorder.add_event(stamp, "switch", "info", "arm started", '{"a": 1}')
        recorder.drain()
        recorder._recording.write_out(end_chunk=True)
    return store.file(recorder.stop().identifier)


def test_notes_are_events_of_the_file_for_every_reader(path):
    times = read_trajectory(path).time
    before = read_events(path)
    rows = list(RecordingTable(path).rows())
    begin, until = float(times[100]), float(times[150])
    first = add_note(path, "it slipped", begin, until, who="ada")
    second = add_note(path, "here", float(times[-1]))

    found = read_events(path)
    assert [e.text for e in found] == sorted(
        [e.text for e in (*before, first, second)],
        key=["it slipped", "arm started", "here"].index,
    )
    (note,) = [event for event in found if event.text == "it slipped"]
    assert (note.time, note.until) == pytest.approx((begin, until), abs=1e-9)
    assert (note.kind, note.details["who"]) == ("note", "ada")
    # What was recorded is what it was, in a file that is as whole as before.
    assert list(RecordingTable(path).rows()) == rows
    recovered = recover_file(path)
    assert not recovered.is_changed
    assert recovered.messages == _count(path)
    # A reader that goes through the file from its begin finds the notes, too.
    with path.open("rb") as file:
        read = NonSeekingReader(file).iter_messages(topics=["/events"])
        assert len(list(read)) == len(found)


def test_a_file_cut_off_within_a_note_loses_the_note_alone(path):
    before = read_trajectory(path).time
    size = path.stat().st_size
    add_note(path, "half of it", float(before[3]))
    path.write_bytes(path.read_bytes()[: size + 20])
    with pytest.raises(RecordingDamagedError):
        add_note(path, "more", float(before[3]))
    recover_file(path)
    assert (read_trajectory(path).time == before).all()


@pytest.mark.parametrize(("begin", "until"), [(-1.0, None), (0.3, 0.29), (0.3, 9.0)])
def test_a_note_outside_of_the_recording_is_refused(path, begin, until):
    before = path.read_bytes()
    with pytest.raises(RecordingRefusedError, match="cannot lie at"):
        add_note(path, "nowhere", begin, until)
    assert path.read_bytes() == before


def test_rows_do_not_wait_for_a_note_on_an_early_time(path):
    add_note(path, "at the begin", float(read_trajectory(path).time[0]))
    table = RecordingTable(path)
    # The rows of the first chunk are complete when the second one begins.
    assert table._limits()[0] > table._chunks[0].message_start_time


def _count(path):
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
        return summary.statistics.message_count
