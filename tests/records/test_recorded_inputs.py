"""The inputs of a station as a recording keeps them."""

import json

import pytest

from station.core.control.switching import SwitchRequest
from station.records import recording
from station.records.recording import RecordedInputs


@pytest.fixture
def written():
    return []


@pytest.fixture
def inputs(station, written):
    """Return what keeps the inputs of a station whose spring runs."""
    station.load_controller("spring", "test/Spring", {"joint": "j"})
    station.loop.step()
    station.switch_controllers(SwitchRequest(start=("spring",)))
    station.inputs.take_inputs()
    return RecordedInputs(station.inputs, lambda text: written.append(json.loads(text)))


def test_a_set_point_is_written_when_it_is_picked_up_and_when_it_expires(
    station, inputs, written
):
    port = station.manager.get_controller("spring").set_points
    station.motion.set_command("spring", [0.5])
    inputs.take(station.loop.cycle)
    assert written == []
    station.loop.step()
    cycle = station.loop.cycle
    inputs.take(cycle)
    port.expire()
    station.loop.step(5)
    port.take_expiry()
    inputs.take(station.loop.cycle)

    assert [(one["kind"], one["after"]) for one in written] == [
        ("set_point", cycle - 1),
        ("expire", cycle + 4),
    ]
    assert inputs.texts == [json.dumps(one) for one in written]


def test_cycles_that_are_late_or_without_time_are_inputs(inputs, written):
    for periods in (1, 3, 0):
        inputs.note_periods(8, periods)

    late, still = written
    assert late == {"after": 7, "kind": "late", "periods": 3}
    assert (still["kind"], still["after"]) == ("operation", 7)


def test_more_inputs_than_a_recording_can_have_are_told_once(
    inputs, written, monkeypatch
):
    monkeypatch.setattr(recording, "MOST_INPUTS", 2)
    for cycle in range(5):
        inputs.note_periods(cycle, 2)

    assert len(inputs.texts) == 2
    assert not inputs.is_whole
    assert [one["kind"] for one in written].count("operation") == 1
