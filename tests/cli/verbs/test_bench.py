"""Verb `bench`."""

import pytest

from station.trials.relay_tuning import RULES
from station.wire import GainsChange
from station.wire.excitations import BenchResponse, GainProposal, PartRequest


class Runs:
    """What `client.bench_runs` is to the command line."""

    def __init__(self, run):
        self._run = run

    def list(self):
        return []

    def get(self, name):
        assert name == self._run.name
        return self._run

    delete = get


@pytest.fixture
def station(station):
    proposal = GainProposal(
        rule="no_overshoot",
        title=RULES["no_overshoot"].title,
        source="",
        gains={"j1/p": 20.0},
        note="Mind the clamp.",
    )
    found = BenchResponse(
        name="relay-1",
        controller="arm",
        joint="j1",
        kind="relay",
        gains={},
        time=[],
        desired=[],
        position=[],
        velocity=[],
        effort=[],
        output=[],
        metrics={"ultimate_gain": 100.0},
        units={"ultimate_gain": "Nm/rad"},
        cycles=1,
        lost=0,
        proposals=[proposal],
    )
    station.asked = []

    def bench(controller, excitation, **options):
        station.asked.append((controller, excitation, options))
        return found

    def read(identifier, part):
        station.asked.append((identifier, part))
        return found

    def set_gains(name, values):
        station.asked.append((name, values))
        return GainsChange(values, {"j1/p": 5.0}, 1, 1, ())

    station.bench, station.set_gains = bench, set_gains
    station.bench_runs = Runs(found)
    station.recordings = type("Recordings", (), {"bench": staticmethod(read)})
    return station


def test_a_relay_test_tells_its_figures_and_the_gains_by_rule(run, station):
    out = run("bench relay j1 --controller arm --relay-gain 50 --keep-as one").out

    ((controller, excitation, options),) = station.asked
    assert (controller, excitation.kind, excitation.amplitude) == ("arm", "relay", 0.1)
    assert (options["relay_gain"], options["run"]) == (50.0, "one")
    assert "ultimate_gain  100" in out
    assert "no_overshoot  20" in out


def test_a_chirp_has_two_frequencies(run, station):
    run("bench chirp j1 --controller arm --frequency 1 5")
    ((_, excitation, _),) = station.asked
    assert (excitation.first, excitation.last) == (1.0, 5.0)


def test_a_part_of_a_recording_is_read(run, station):
    run("bench step j1 --controller arm --recording walk --begin 1 --end 2")
    ((identifier, part),) = station.asked
    wanted = PartRequest(controller="arm", joint="j1", kind="step", begin=1.0, end=2.0)
    assert (identifier, part.begin, part.kind) == ("walk", wanted.begin, wanted.kind)


def test_a_rule_is_applied_and_its_note_told(run, station):
    out = run("bench apply relay-1 --rule no_overshoot").out
    assert station.asked == [("arm", {"j1/p": 20.0})]
    assert out.splitlines()[1].split() == ["j1/p", "5", "20"]
    assert "Note: Mind the clamp." in out


@pytest.mark.parametrize(
    "line",
    [
        "bench step",
        "bench list one",
        "bench sine j1 --frequency 1 2",
        "bench chirp j1 --frequency 1",
        "bench sine j1 --frequency -1",
        "bench apply relay-1",
        "bench apply relay-1 --rule nobody",
    ],
)
def test_wrong_words_are_wrong_usage(run, station, line):
    assert run(line).code == 2
    assert station.asked == []
