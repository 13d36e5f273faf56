"""Streaming and jogging the simulated arm."""

from math import sin

import pytest

from station.app.composition import compose
from station.config import load_config
from station.core.clock import ManualClock
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
P = [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0]
D = [30.0, 30.0, 30.0, 30.0, 10.0, 10.0, 5.0]
PARAMETERS = {
    "joints": JOINTS,
    "gains": {
        name: {"p": p, "i": 0.0, "d": d}
        for name, p, d in zip(JOINTS, P, D, strict=True)
    },
}
KINDS = ["effort", "position"]


def make_station(kind: str, motion: str) -> Station:
    clock = ManualClock()
    station = compose(load_config(), clock).station
    station.load_controller(
        "arm", f"{kind}_controllers/Joint{motion}Controller", PARAMETERS
    )
    station.switch_controllers(SwitchRequest(start=("arm",)))
    step(station, 5)
    return station


def step(station: Station, cycles: int) -> None:
    for _ in range(cycles):
        station.loop.clock.advance(0.001)
        station.loop.step()


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_stream_of_thirty_set_points_a_second_is_followed(kind: str) -> None:
    station = make_station(kind, "Streaming")
    start = list(station.latest().position)
    worst = 0.0
    for number in range(100):
        target = [q + 0.3 * sin(number / 30.0) for q in start]
        station.motion.set_command("arm", target)
        step(station, 33)
        sample = station.controller_sample("arm")
        worst = max(worst, *(abs(each) for each in sample.error))
    assert station.controller("arm").state.value == "running"
    assert worst < 0.02
    assert list(station.latest().position) == pytest.approx(target, abs=0.08)
    step(station, 1_500)  # silence
    held = list(station.latest().position)
    step(station, 500)
    assert list(station.latest().position) == pytest.approx(held, abs=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_a_held_button_jogs_a_joint_and_letting_go_stops_it(kind: str) -> None:
    station = make_station(kind, "Jog")
    start = list(station.latest().position)
    for _ in range(10):
        station.motion.set_command("arm", [0.2] + [0.0] * 6)
        step(station, 50)
    assert station.latest().velocity[0] == pytest.approx(0.2, abs=0.02)
    step(station, 600)
    held = list(station.latest().position)
    step(station, 300)

    assert list(station.latest().position) == pytest.approx(held, abs=1e-3)
    assert held[0] - start[0] == pytest.approx(0.2 * 0.7, abs=0.06)
    assert held[1:] == pytest.approx(start[1:], abs=2e-3)
