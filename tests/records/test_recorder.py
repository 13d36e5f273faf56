"""Recording a stepped station: every cycle once, failures told, incidents kept."""

import errno
import json
from itertools import count

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from station.core.control.switching import SwitchRequest
from station.core.errors import RecordingRefusedError
from station.records.mcap_file import DiskFile
from station.records.record_store import FAILED, Quota, RecordStore
from station.records.recorder import Recorder
from station.records.recording import Recording
from station.records.recording_events import read_events
from station.records.recording_reader import (
    read_inputs,
    read_messages,
    read_texts,
    read_trajectory,
)
from tests.api.spring import make_station
from tests.franka_station import make_franka_station


def _run(station, recorder, cycles, every=200):
    for _ in range(0, cycles, every):
        station.loop.step(every)
        recorder.drain()


def test_every_cycle_is_recorded_once(station, recorder, store):
    started = recorder.start("demo", "a note")
    _run(station, recorder, 1000)
    stopped = recorder.stop(started.identifier)

    assert (stopped.state, stopped.error, stopped.lost) == ("stopped", None, 0)
    assert (stopped.first_cycle, stopped.last_cycle, stopped.cycles) == (1, 1000, 1000)
    found = read_trajectory(store.file(stopped.identifier))
    assert found.names == ("j",)
    assert np.array_equal(found.cycle, np.arange(1, 1001))
    assert np.all(found.position == 0.25)
    assert store.info(stopped.identifier) == stopped


def test_what_controllers_ask_for_and_what_is_sent_is_recorded(
    station, recorder, store
):
    station.load_controller("arm", "test/Spring", {"joint": "j", "k": 2.0})
    station.switch_controllers(SwitchRequest(start=["arm"]))
    recorder.start()
    station.motion.set_command("arm", [0.5])
    _run(station, recorder, 10, every=5)
    path = store.file(recorder.stop().identifier)

    asked = [m for _, m in read_messages(path, ["/controllers/arm"])]
    sent = [m for _, m in read_messages(path, ["/commands/effort"])]
    assert [m["output"] for m in asked] == [[0.5]] * 10
    assert [m["command"] for m in sent] == [[0.5]] * 10
    assert (asked[0]["name"], asked[0]["desired"], asked[0]["actual"]) == (
        ["j"], [0.5], [0.25],
    )  # fmt: skip


def test_the_nearest_pair_of_an_arm_is_recorded_in_every_cycle(store, incidents):
    ball = {"type": "sphere", "size": [0.1], "position": [0.8, 0, 0.5]}
    places = [{"name": "ball", "role": "keep_out", **ball}]
    station = make_franka_station(objects=places)
    recorder = Recorder(station, store, incidents, wall_time=lambda: 10**18)
    recorder.start()
    told = []
    for _ in range(20):
        station.loop.step()
        told.append(station.surroundings.clearance("panda"))
    recorder.drain()
    path = store.file(recorder.stop().identifier)
    recorder.close()

    found = [m for _, m in read_messages(path, ["/clearance/panda"])]
    assert [m["distance"] for m in found] == [one.distance for one in told]
    assert {(m["link"], m["object"], m["margin"]) for m in found} == {
        (told[0].link, "ball", 0.02)
    }
    # The ball begins 0.7 m in front of the base, the hand ends at 0.36 m.
    assert 0.33 < told[0].distance < 0.37


def test_an_independent_reader_reads_the_file(station, recorder, store):
    recorder.start()
    _run(station, recorder, 100, every=50)
    path = store.file(recorder.stop().identifier)

    states, cycles = [], []
    with AnyReader([path], default_typestore=get_typestore(Stores.EMPTY)) as reader:
        for connection, _, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            if connection.topic == "/joint_states":
                states.append(message)
            elif connection.topic == "/cycles":
                cycles.append(message)

    assert [list(s.position) for s in states] == [[0.25]] * 100
    assert [c.cycle for c in cycles] == list(range(1, 101))
    assert states[1].header.stamp.nanosec - states[0].header.stamp.nanosec == 1_000_000


def test_gains_are_recorded_when_they_change_and_inputs_with_their_cycle(
    station, recorder, store
):
    station.load_controller("arm", "test/Spring", {"joint": "j", "k": 2.0})
    recorder.start()
    _run(station, recorder, 10, every=5)
    station.tuning.set_gains("arm", {"k": 3.0})
    _run(station, recorder, 10, every=5)
    path = store.file(recorder.stop().identifier)

    gains = [json.loads(text) for text in read_texts(path, "/gains")]
    assert gains == [{"arm": {"k": 2.0}}, {"arm": {"k": 3.0}}]
    changes = [one for one in read_inputs(path) if one["kind"] == "gains"]
    assert changes == [{"after": 10, "kind": "gains", "changes": {"arm": {"k": 3.0}}}]


def test_events_are_recorded(station, recorder, store):
    recorder.add_event(0.0, "stop", "info", "Before the recording.", "{}")
    recorder.start()
    _run(station, recorder, 2, every=1)
    recorder.add_event(0.001, "switch", "info", "Started arm.", '{"by": "ana"}')
    _run(station, recorder, 2, every=1)
    path = store.file(recorder.stop().identifier)

    ((_, event),) = read_messages(path, ["/events"])
    assert (event["kind"], event["text"], event["details"]) == (
        "switch", "Started arm.", '{"by": "ana"}',
    )  # fmt: skip


def test_cycles_that_were_overwritten_are_counted(station, recorder):
    recorder.start()
    station.loop.step(5000)
    stopped = recorder.stop()

    assert stopped.cycles == 4096
    assert stopped.lost >= 5000 - 4096


def test_the_recording_that_runs_is_stopped_by_a_name_that_older_ones_have(recorder):
    older = recorder.start("pick")
    assert recorder.stop("pick").identifier == older.identifier
    newer = recorder.start("pick")

    assert recorder.info(newer.identifier).state == "recording"
    assert recorder.stop("pick").identifier == newer.identifier
    with pytest.raises(RecordingRefusedError, match="2 recordings are called 'pick'"):
        recorder.stop("pick")


def test_one_recording_runs_at_a_time(recorder):
    first = recorder.start()
    with pytest.raises(RecordingRefusedError, match=first.identifier):
        recorder.start()
    with pytest.raises(RecordingRefusedError, match="is being recorded"):
        recorder.store.delete(first.identifier)
    recorder.stop()
    with pytest.raises(RecordingRefusedError, match="Nothing is being recorded"):
        recorder.stop()


class _FullDisk(DiskFile):
    """A disk with room for so many bytes, of which it takes what fits."""

    room = 0

    def write(self, data):
        left = self.room - self.size
        if left <= 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        return super().write(bytes(data)[:left])


def _record_with_room(folder, room):
    """Record 600 cycles on a disk with so much room; return recorder, station, info."""
    station, store = make_station(), RecordStore(folder)
    # Not a constant of the class: examples must not see each other's disk.
    disk = type("Disk", (_FullDisk,), {"room": room})
    recorder = Recorder(station, store, open_file=disk, wall_time=lambda: 10**18)
    identifier = recorder.start().identifier
    for _ in range(6):
        station.loop.step(100)
        recorder.drain()
    recorder.close()
    assert recorder.last.identifier == identifier
    return recorder, station


def test_a_disk_that_is_full_at_any_byte_is_told_and_the_loop_goes_on(tmp_path):
    whole, _ = _record_with_room(tmp_path / "whole", 10**9)
    names = count()

    @settings(max_examples=40, derandomize=True, database=None, deadline=None)
    # Durations of the loop, which differ, take more or less room when compressed.
    @given(room=st.integers(0, whole.last.size - 4000))
    @example(room=0)
    @example(room=8)  # after the magic
    def check(room):
        recorder, station = _record_with_room(tmp_path / str(next(names)), room)

        last = recorder.last
        assert last.state == FAILED
        assert "No space left on device" in last.error
        assert recorder.store.info(last.identifier) == last
        assert station.loop.cycle == 600
        assert recorder.failure is None
        size = recorder.store.file(last.identifier).stat().st_size
        assert size == min(room, last.size)

    assert whole.last.state != FAILED
    check()


def test_the_quota_ends_a_recording_and_refuses_the_next(station, tmp_path):
    store = RecordStore(tmp_path, Quota(bytes=2000))
    recorder = Recorder(station, store)
    recorder.start()
    for _ in range(50):
        station.loop.step(100)
        recorder.drain()
    recorder.close()

    assert recorder.last.state == FAILED
    assert "quota of 2000 bytes" in recorder.last.error
    with pytest.raises(RecordingRefusedError, match="2000 bytes"):
        recorder.start()


def test_a_stop_is_kept_with_what_was_before_and_after(station, recorder, incidents):
    _run(station, recorder, 11_000)
    station.stop("somebody shouted")
    _run(station, recorder, 2600)

    (incident,) = incidents.infos()
    assert incident.causes == ("The station was stopped: somebody shouted.",)
    found = read_trajectory(incidents.file(incident.identifier))
    (cause,) = read_events(incidents.file(incident.identifier))
    assert (cause.kind, cause.text) == ("incident", incident.causes[0])
    assert cause.time == pytest.approx(found.time[-1] - 2.0, abs=1e-3)
    assert found.time[0] == pytest.approx(1.0, abs=0.002)
    assert found.time[-1] == pytest.approx(13.0, abs=0.002)
    assert np.all(np.diff(found.cycle) == 1)


def test_a_burst_of_overruns_is_kept(station, recorder, incidents):
    _run(station, recorder, 200)
    station.loop.delay_next_cycle(7)
    _run(station, recorder, 2600)

    (incident,) = incidents.infos()
    assert "deadlines" in incident.causes[0]


def test_incidents_are_bounded_in_number(station, recorder, incidents):
    for number in range(4):
        station.stop(f"stop {number}")
        _run(station, recorder, 2600)

    causes = [one.causes[0] for one in incidents.infos()]
    assert len(causes) == 3
    assert "stop 3" in causes[-1]


def test_begin_and_end_are_told(station, recorder):
    told = []
    recorder.tell = told.append
    recorder.start("walk")
    _run(station, recorder, 5, every=5)
    recorder.stop()

    assert [(one.name, one.state) for one in told] == [
        ("walk", "recording"),
        ("walk", "stopped"),
    ]
    assert told[1].cycles == 5


def test_late_cycles_while_a_recording_begins_are_inputs_but_not_rows(station, store):
    def open_late(path):
        station.loop.delay_next_cycle(4)
        station.loop.step(2)
        return DiskFile(path)

    recorder = Recorder(station, store, open_file=open_late)
    station.loop.step(3)
    identifier = recorder.start("late").identifier
    station.loop.step(2)
    recorder.stop()
    recorder.close()

    path = store.file(identifier)
    assert read_trajectory(path).cycle.tolist() == [6, 7]
    late = [one for one in read_inputs(path) if one["kind"] == "late"]
    assert late == [{"after": 3, "kind": "late", "periods": 5}]


def test_each_cycle_has_all_its_messages_or_none(station, recorder, store, monkeypatch):
    opened, ring = Recording.open_sources, station.snapshots

    def open_late(recording):
        opened(recording)
        station.loop.step(2)  # sampled, but before the first cycle of the recording

    class Read:
        def rows_since(self, cycle):
            rows = ring.rows_since(cycle)
            station.loop.step(2)  # the loop goes on before the samples are read
            return rows

    monkeypatch.setattr(Recording, "open_sources", open_late)
    identifier = recorder.start().identifier
    monkeypatch.setattr(station.loop, "snapshots", Read())
    for _ in range(20):
        station.loop.step(3)
        recorder.drain()
    stopped = recorder.stop()

    found = {}
    for topic, message in read_messages(store.file(identifier)):
        if "header" in message:
            stamp = message["header"]["stamp"]
            found.setdefault(topic, []).append((stamp["sec"], stamp["nanosec"]))
    assert found["/commands/effort"] == found["/cycles"] == found["/joint_states"]
    assert len(found["/cycles"]) == stopped.cycles > 80
    assert stopped.lost == 0


def test_a_cycle_that_several_channels_lack_is_lost_once(station, recorder):
    recorder.start()
    station.loop.step(5000)
    stopped = recorder.stop()

    assert (stopped.cycles, stopped.lost) == (4096, 5000 - 4096)
