"""A recording row by row: what is chosen, in constant memory."""

import csv
import io
import tracemalloc

import numpy as np
import pytest

from station.core.control.switching import SwitchRequest
from station.core.errors import RecordingDamagedError, RecordingRefusedError
from station.core.franka.franka_robot_state import RobotState
from station.records import messages
from station.records.cdr import Form
from station.records.cycle_messages import CycleMessages
from station.records.recording_reader import read_messages
from station.records.recording_table import Choice, RecordingTable, csv_pieces


def _record(station, recorder, store, cycles):
    recorder.start()
    for _ in range(0, cycles, 50):
        station.loop.step(50)
        recorder.drain()
        recorder._recording.write_out(end_chunk=True)
    return store.file(recorder.stop().identifier)


@pytest.fixture
def path(station, recorder, store):
    """Return a recording of 400 cycles in chunks, a controller running."""
    station.load_controller("arm", "test/Spring", {"joint": "j", "k": 2.0})
    station.switch_controllers(SwitchRequest(start=["arm"]))
    return _record(station, recorder, store, 400)


def _read(path, **choice):
    text = "".join(csv_pieces(path, Choice(**choice)))
    head, *rows = csv.reader(io.StringIO(text))
    return head, rows


def test_a_form_reads_the_numbers_that_a_decoder_reads():
    state = RobotState()
    state.q = [0.1 * k for k in range(7)]
    state.time = 3.5
    message = CycleMessages(0).of_arm("panda", 2.25, state.packed())
    form = Form(messages.FRANKA_STATE, message.data)
    whole = messages.FRANKA_STATE.decode(message.data)

    read = form.reader(range(len(form.names)))(message.data)

    for (field, element), value in zip(form.names, read, strict=True):
        expected = whole
        for part in field.split("/"):
            expected = expected[part]
        assert value == (expected if element is None else expected[int(element)])
    assert len(read) > 300
    assert form.reader([5, 20])(message.data) == (read[5], read[20])
    assert form.fits(message.data)
    assert not form.fits(message.data[:-1])


def test_a_form_fits_messages_with_the_same_texts_alone():
    def state(*names):
        return messages.JOINT_STATE.encode({
            "header": messages.header(5),
            "name": list(names),
            "position": [1.0, 2.0],
            "velocity": [],
            "effort": [],
        })

    form = Form(messages.JOINT_STATE, state("a", "b"))
    assert form.names[-2:] == [("position", "a"), ("position", "b")]
    assert form.fits(state("a", "b"))
    assert not form.fits(state("a", "c"))


def test_whole_numbers_are_written_as_such(path):
    _, rows = _read(path)
    assert [row[0] for row in rows] == [str(k) for k in range(2, 402)]
    assert {row[3] for row in rows} == {"1"}


def test_chosen_are_channels_fields_joints_and_a_rate(path):
    head, rows = _read(
        path, channels=("/joint_states/position", "commands"), joints=("j",), rate=100.0
    )

    assert head[4:] == ["joint_states/position/j", "commands/effort/command/j"]
    assert [int(row[0]) for row in rows] == list(range(2, 402, 10))
    sent = {
        m["header"]["stamp"]["nanosec"]: m["command"][0]
        for _, m in read_messages(path, ["/commands/effort"])
    }
    assert [float(row[5]) for row in rows] == list(sent.values())[::10]


@pytest.mark.parametrize(
    ("choice", "told"),
    [
        ({"channels": ("joint_state",)}, "no channel 'joint_state'"),
        ({"channels": ("events",)}, "no channel 'events' with numbers"),
        ({"joints": ("k",)}, "no joint 'k'"),
    ],
)
def test_what_the_recording_does_not_have_is_refused(path, choice, told):
    with pytest.raises(RecordingRefusedError, match=told):
        csv_pieces(path, Choice(**choice))


def test_a_damaged_chunk_is_told_before_the_first_row(path):
    data = bytearray(path.read_bytes())
    data[data.rindex(b"lz4", 0, len(data) // 2) + 60] ^= 1
    path.write_bytes(data)
    with pytest.raises(RecordingDamagedError, match="cannot be read"):
        csv_pieces(path, Choice())


def test_memory_does_not_grow_with_the_recording(station, recorder, store):
    peaks = []
    for cycles in (400, 4000):
        path = _record(station, recorder, store, cycles)
        tracemalloc.start()
        count = sum(1 for _ in RecordingTable(path).rows())
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert count == cycles

    # All rows of 3600 more cycles would be a megabyte; garbage of other tests, which
    # counts too, is a tenth of that.
    assert peaks[1] < peaks[0] + 500_000


def test_a_joint_that_takes_another_name_gets_a_column_of_its_own():
    first, second = (
        messages.JOINT_COMMANDS.encode({
            "header": messages.header(5),
            "name": [name],
            "command": [1.0],
        })
        for name in ("a", "b")
    )
    forms = [Form(messages.JOINT_COMMANDS, data) for data in (first, second)]
    assert [form.names[-1] for form in forms] == [("command", "a"), ("command", "b")]
    assert np.all([not forms[0].fits(second), not forms[1].fits(first)])
