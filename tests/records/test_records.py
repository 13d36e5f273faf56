"""Rows, messages and the reader of recordings, in small."""

import errno
import os
import stat
from array import array
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from mcap_ros2._dynamic import generate_dynamic

from station.core.control.controller import ControllerSample
from station.core.errors import (
    RecordingFileError,
    RecordingNotFoundError,
    RecordingRefusedError,
)
from station.core.franka.franka_errors import ERROR_NAMES
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.records import messages
from station.records.cycle_messages import CycleMessages, RowPacker
from station.records.mcap_file import DiskFile
from station.records.mcap_recovery import recover_file
from station.records.record_store import (
    FAILED,
    KILLED,
    RECORDING,
    STOPPED,
    RecordStore,
)
from station.records.recording_reader import Trajectory, read_trajectory


def _doubles(memory):
    return array("d", bytes(memory)).tolist()


def test_a_row_keeps_a_cycle():
    packer = RowPacker(["a", "b"], {"arm": ["a", "b"], "other": []}.get)
    packed = array("d", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).tobytes()
    sample = ControllerSample(0.5, [1.0, 2.0], [3.0, 4.0], [5.0, 6.0], [7.0, 8.0])
    one = ControllerSample(0.5, [1.0], [2.0], [3.0], [4.0])

    packed_row = packer.pack((
        7,
        2,
        0.5,
        0.001,
        "move",
        packed,
        {"arm": sample, "other": one},
    ))
    row = packer.unpack(packed_row)

    assert isinstance(packed_row, bytes)
    assert row[:4] == (7, 2, 0.5, 0.001)
    assert _doubles(row.joints) == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert [_doubles(m) for m in row.samples] == [
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
        [1.0, 2.0, 3.0, 4.0],
    ]
    assert (row.form.mode, row.form.joints) == ("move", ("a", "b"))
    assert row.form.samples == (("arm", ("a", "b")), ("other", ("0",)))


def test_a_controller_loaded_anew_is_kept_under_its_new_joints():
    joints = {"arm": ["a"]}
    packer = RowPacker(["a", "b"], lambda name: joints[name])
    packed = array("d", [0.0] * 6).tobytes()
    one = ControllerSample(0.5, [1.0], [2.0], [3.0], [4.0])

    def elements(samples):
        row = packer.unpack(packer.pack((1, 1, 0.5, 0.001, "move", packed, samples)))
        return [sample.elements for sample in row.form.samples]

    assert elements({"arm": one}) == [("a",)]
    assert elements({}) == []
    joints["arm"] = ["b"]
    assert elements({"arm": one}) == [("b",)]


def test_a_franka_state_is_what_an_independent_decoder_reads():
    state = RobotState()
    lengths = {f.name: f.length for f in messages.FRANKA_STATE.fields if f.length}
    names = [one.name for one in fields(RobotState) if one.name.lower() in lengths]
    assert len(names) == len(lengths)
    arrays = {name: lengths[name.lower()] for name in names}
    for number, (name, size) in enumerate(arrays.items()):
        setattr(state, name, [100.0 * number + i for i in range(size)])
    state.time, state.m_ee, state.m_load, state.m_total = 1.5, 0.7, 0.2, 0.9
    state.control_command_success_rate = 0.99
    state.robot_mode = RobotMode.REFLEX
    flags = [False] * len(ERROR_NAMES)
    flags[ERROR_NAMES.index("power_limit_violation")] = True
    state.last_motion_errors = flags

    message = CycleMessages(0).of_arm("panda", 2.25, state.packed())

    kind = messages.FRANKA_STATE
    read = generate_dynamic(kind.name, kind.text)[kind.name](message.data)
    assert message.topic == "/franka_state/panda"
    assert (read.header.stamp.sec, read.header.stamp.nanosec) == (2, 250_000_000)
    for name in (*arrays, "time", "m_ee", "m_load", "m_total"):
        found = getattr(read, name.lower())
        assert (list(found) if name in arrays else found) == getattr(state, name)
    assert read.control_command_success_rate == 0.99
    assert read.robot_mode == RobotMode.REFLEX.value
    raised = [name for name in ERROR_NAMES if getattr(read.last_motion_errors, name)]
    assert raised == ["power_limit_violation"]
    assert not any(getattr(read.current_errors, name) for name in ERROR_NAMES)


def test_a_trajectory_is_decimated_by_station_time():
    time = np.arange(1, 1001) * 0.001
    columns = np.arange(1000.0).reshape(1000, 1)
    cycle = np.arange(1, 1001)
    whole = Trajectory(("j",), cycle, time, time, columns, columns, columns)

    found = whole.decimated(10.0)

    assert found.cycle.tolist() == list(range(1, 1001, 100))
    assert found.position[:, 0].tolist() == list(range(0, 1000, 100))


def test_what_is_no_recording_cannot_be_read(tmp_path):
    path = tmp_path / "x.mcap"
    path.write_bytes(b"nothing of the kind, but long enough for a magic number")
    with pytest.raises(RecordingFileError, match="cannot be read"):
        read_trajectory(path)


@pytest.mark.parametrize("identifier", ["nothing", "../x", "a/b", ""])
def test_an_unknown_recording_is_refused(store, identifier):
    with pytest.raises(RecordingNotFoundError, match="There is no recording"):
        store.info(identifier)


@pytest.fixture
def begin(store):
    """Return what begins a recording in the store, and keeps its file open."""
    files = []

    def begin(*about):
        info, file = store.begin(DiskFile, *about)
        files.append(file)
        return info

    yield begin
    for file in files:
        file.close()


def test_a_recording_is_found_by_its_name_while_no_other_has_it(store, begin):
    pick = begin("pick")
    begin("my-pick")
    begin()

    assert store.info("pick") == store.info(pick.identifier) == pick
    other = begin("pick")
    with pytest.raises(
        RecordingRefusedError, match="2 recordings are called 'pick'"
    ) as e:
        store.info("pick")
    for one in (pick, other):
        assert one.identifier in e.value.remedy
    with pytest.raises(RecordingNotFoundError):
        store.info("")


def test_a_recording_that_has_the_name_as_its_id_is_meant(store, begin):
    first = begin("pick")
    begin(first.identifier)

    assert store.info(first.identifier) == first


def test_a_description_that_finds_no_room_leaves_nothing(store, begin, monkeypatch):
    info = begin("a")
    before = sorted(store.folder.iterdir())

    def write(path, _text, **_kinds):
        path.touch()
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_text", write)

    assert store.keep(replace(info, note="new")).errno == errno.ENOSPC
    assert sorted(store.folder.iterdir()) == before


def test_a_recording_is_deleted_by_its_name(store):
    info, file = store.begin(DiskFile, "pick")
    file.close()
    store.keep(replace(info, state=STOPPED))

    store.delete("pick")

    assert list(store.folder.iterdir()) == []


def test_two_stations_in_the_same_instant_get_files_of_their_own(tmp_path):
    stores = [RecordStore(tmp_path, now=lambda: 1e9) for _ in range(2)]
    begun = [store.begin(DiskFile, "pick") for store in stores]

    assert [info.identifier for info, _ in begun] == [
        "20010909T014640000-pick",
        "20010909T014640000-pick-2",
    ]
    for _, file in begun:
        file.close()


def test_what_another_station_records_is_neither_deleted_nor_recovered(tmp_path):
    mine, other = RecordStore(tmp_path), RecordStore(tmp_path)
    info, file = mine.begin(DiskFile, "pick")
    file.write(b"\x89MCAP0\r\n")

    assert other.recover() == []
    assert other.info("pick").state == RECORDING
    with pytest.raises(RecordingRefusedError, match="is being recorded"):
        other.delete("pick")
    with pytest.raises(RecordingRefusedError, match="is being recorded"):
        recover_file(other.file(info.identifier))
    # A description that came too early does not help either.
    mine.keep(replace(info, state=STOPPED))
    other.drop_oldest(0)
    assert other.file(info.identifier).exists()

    file.close()
    other.drop_oldest(0)
    assert list(tmp_path.iterdir()) == []


def test_a_recording_whose_station_is_gone_is_no_longer_being_recorded(store):
    info, file = store.begin(DiskFile, "pick")
    file.close()

    found = store.info(info.identifier)

    assert (found.state, found.error) == (FAILED, KILLED)
    assert store.interrupted() == [info.identifier]


@pytest.mark.parametrize(
    "text",
    [
        '{"identifier": "../../x", "state": "stopped"}',
        '{"identifier": "other", "state": "recording"}',
        '{"identifier": "bad", "cycles": "many"}',
        '{"identifier": "bad", "state": "asleep"}',
        '{"identifier": "bad", "error": 3}',
        "[1, 2]",
        "no JSON",
        "\xff" * 100_000,
    ],
)
def test_a_bad_description_is_skipped_and_told(store, begin, text):
    good = begin("good")
    (store.folder / "bad.json").write_text(text, encoding="latin-1")
    (store.folder / "bad.mcap").write_bytes(b"untouched")

    assert store.infos() == [good]
    assert store.recover() == []
    (told,) = store.skipped()
    assert told.startswith("bad.json: ")
    assert (store.folder / "bad.mcap").read_bytes() == b"untouched"
    with pytest.raises(RecordingNotFoundError):
        store.info("bad")


def test_a_pipe_among_the_recordings_holds_nobody_up(store, begin):
    good = begin("good")
    os.mkfifo(store.folder / "pipe.json")
    os.mkfifo(store.folder / "pipe.mcap")

    assert store.infos() == [good]
    assert store.skipped() == ["pipe.json: pipe.json is no regular file"]
    with pytest.raises(RecordingFileError, match="no regular file"):
        read_trajectory(store.file("pipe"))
    with pytest.raises(RecordingFileError, match="no regular file"):
        recover_file(store.file("pipe"))


def test_all_folders_are_private(tmp_path):
    folder = tmp_path / "share" / "control-station" / "recordings" / "incidents"
    old_mask = os.umask(0o022)
    try:
        _, file = RecordStore(folder).begin(DiskFile)
    finally:
        os.umask(old_mask)
    file.close()

    for one in (folder, folder.parent, folder.parent.parent):
        assert stat.S_IMODE(one.stat().st_mode) == 0o700


def test_a_store_of_incidents_calls_them_so(tmp_path):
    with pytest.raises(RecordingNotFoundError, match="There is no incident 'x'"):
        RecordStore(tmp_path, noun="incident").info("x")
