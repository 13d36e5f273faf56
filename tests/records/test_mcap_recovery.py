"""Recovery of files that end anywhere."""

import pytest
from mcap.reader import make_reader

from station.core.errors import RecordingFileError
from station.records.mcap_recovery import recover_file
from station.records.recording_reader import read_facts, read_trajectory


@pytest.fixture
def whole(station, recorder, store):
    """Return the path of a whole recording of 400 cycles in several chunks."""
    recorder.start("whole")
    for _ in range(40):
        station.loop.step(10)
        recorder.drain()
        recorder._recording.write_out(end_chunk=True)
    return store.file(recorder.stop().identifier)


def test_a_whole_file_stays_as_it_is(whole):
    before = whole.read_bytes()
    recovered = recover_file(whole)
    assert not recovered.is_changed
    assert whole.read_bytes() == before


@pytest.mark.parametrize("part", [0.15, 0.3, 0.5, 0.61, 0.72, 0.8, 0.85])
def test_a_truncated_file_is_recovered_up_to_its_last_chunk(whole, tmp_path, part):
    data = whole.read_bytes()
    for offset in range(0, 200, 43):
        path = tmp_path / "cut.mcap"
        path.write_bytes(data[: int(part * len(data)) + offset])

        recovered = recover_file(path)

        found = read_trajectory(path)
        assert recovered.is_changed
        assert list(found.cycle) == list(range(1, len(found.cycle) + 1))
        assert len(found.cycle) > 0
        assert read_facts(path)["name"] == "whole"
        with path.open("rb") as file:
            summary = make_reader(file, validate_crcs=True).get_summary()
        assert summary.statistics.message_count == recovered.messages
        assert not recover_file(path).is_changed


def test_a_killed_stations_recording_is_recovered_at_the_next_start(whole, store):
    identifier = whole.stem
    info = store.info(identifier)
    store.keep(type(info)(identifier, name="whole"))
    whole.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])

    (recovered,) = store.recover()

    assert recovered.state == "recovered"
    assert "bytes were cut off" in recovered.error
    assert store.info(identifier) == recovered
    assert store.recover() == []


@pytest.mark.parametrize("data", [b"", b"\x89MCAP", b"no recording at all"])
def test_what_is_no_recording_is_refused(tmp_path, data):
    path = tmp_path / "other.mcap"
    path.write_bytes(data)
    with pytest.raises(RecordingFileError, match="is no recording"):
        recover_file(path)
    assert path.read_bytes() == data


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(RecordingFileError, match="cannot be recovered"):
        recover_file(tmp_path / "nothing.mcap")
