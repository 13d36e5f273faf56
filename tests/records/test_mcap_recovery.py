"""Recovery of files that end anywhere."""

import pytest
from mcap.reader import make_reader

from station.core.errors import RecordingFileError
from station.records.mcap_recovery import recover_file
from station.records.recording_reader import read_trajectory


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
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            summary = reader.get_summary()
            (facts,) = reader.iter_metadata()
        assert facts.metadata["name"] == "whole"
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


def _messages(path):
    with path.open("rb") as file:
        return [
            (channel.topic, message.log_time, message.data)
            for _, channel, message in make_reader(
                file, validate_crcs=True
            ).iter_messages(log_time_order=False)
        ]


@pytest.mark.parametrize(
    ("part", "bit"),
    [
        pytest.param(k / 23, bit, marks=[] if i == k % 3 else pytest.mark.long)
        for k in range(23)
        for i, bit in enumerate((0, 4, 7))
    ],
)
def test_one_flipped_byte_loses_no_more_than_its_chunk(whole, tmp_path, part, bit):
    data = bytearray(whole.read_bytes())
    data[round(part * len(data))] ^= 1 << bit
    path = tmp_path / "flipped.mcap"
    path.write_bytes(data)

    recovered = recover_file(path)

    before, after = _messages(whole), _messages(path)
    assert recovered.is_changed
    assert recovered.messages == len(after)
    assert recovered.lost_messages == len(before) - len(after)
    assert set(after) <= set(before)
    assert len(after) >= len(before) * 0.85
    assert bool(recovered.losses) == (len(after) < len(before))
    lost = {stamp for topic, stamp, _ in set(before) - set(after) if topic == "/cycles"}
    for loss in recovered.losses:
        assert all((loss.begin or 0) <= one for one in lost)
        assert all(one <= (loss.end or 2**63) for one in lost)
    assert not recover_file(path).is_changed


def test_a_flipped_byte_in_a_file_without_its_end_is_survived(whole, tmp_path):
    data = bytearray(whole.read_bytes()[: int(0.6 * whole.stat().st_size)])
    data[data.index(b"lz4", len(data) // 2) + 100] ^= 16
    path = tmp_path / "both.mcap"
    path.write_bytes(data)

    recovered = recover_file(path)

    found = read_trajectory(path)
    lost = recovered.lost_cycles
    assert lost == 10
    assert len(found.cycle) == recovered.cycles == found.cycle[-1] - lost
    # /cycles and /joint_states, and what is sampled besides.
    assert recovered.lost_messages >= 2 * lost
    assert f"{recovered.lost_messages} messages are lost: between" in recovered.text()


def test_a_damaged_first_chunk_takes_the_names_of_its_channels_alone(whole, tmp_path):
    data = bytearray(whole.read_bytes()[: int(0.6 * whole.stat().st_size)])
    data[data.index(b"lz4") + 40] ^= 16
    path = tmp_path / "first.mcap"
    path.write_bytes(data)

    recovered = recover_file(path)

    found = _messages(path)
    assert len(found) == recovered.messages > 0
    assert all(topic.startswith("/unknown/") for topic, _, _ in found)


def test_a_chunk_that_ends_in_the_middle_of_nowhere_is_found_again(whole, tmp_path):
    data = bytearray(whole.read_bytes())
    begin = len(data) // 3
    data[begin : begin + 2000] = bytes(2000)
    path = tmp_path / "hole.mcap"
    path.write_bytes(data)

    recovered = recover_file(path)

    assert recovered.lost_messages == len(_messages(whole)) - len(_messages(path)) > 0
    assert read_trajectory(path).cycle[-1] == 400
