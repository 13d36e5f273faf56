"""Verbs that move the robot or keep it from moving."""

import json

import pytest

from station.cli import main
from station.cli.verbs.motion import WatchdogStop
from station.client import StationUnreachableError
from station.wire import StopState


def test_command_sends_the_set_point(run, station):
    outcome = run("command arm 0.1 -2 -3e-1")

    assert outcome.code == 0
    assert station.calls == [("command", "arm", [0.1, -2.0, -0.3])]


def test_stop_stops_the_robot(run, station):
    outcome = run("stop --reason test")

    assert station.calls == [("stop", "test")]
    assert "station release" in outcome.out


def test_stop_with_loaded_controllers_stops_these_alone(run, station):
    assert run("stop arm leg").code == 0
    assert station.calls == [("controllers",), ("switch", {"stop": ["arm"]})]


def test_stop_with_any_other_word_stops_the_robot(run, station):
    run("stop now")

    assert station.calls == [("controllers",), ("stop", "now")]


@pytest.mark.parametrize(
    "failure",
    [StationUnreachableError("http://x", OSError("refused")), ValueError("odd answer")],
)
def test_stop_is_sent_even_when_the_list_fails(run, station, failure):
    def fail():
        station.calls.append(("controllers",))
        raise failure

    station.controllers = fail

    assert run("stop arm").code == 0
    assert station.calls == [("controllers",), ("stop", "arm")]


def test_release_takes_two_steps(run, station):
    first, second = run("release"), run("release --arm")

    assert station.calls == [("release", False), ("release", True)]
    assert "nothing moves yet" in first.out
    assert "Motion is possible" in second.out


def test_stop_state_can_be_json(run):
    assert json.loads(run("stop --json").out)["state"] == "stopped"


def test_recover_takes_all_arms_at_once(run, station):
    outcome = run("recover")

    assert station.calls == [("recover_all", "none")]
    assert outcome.out.splitlines() == [
        "left is idle.",
        "Caution: It is touched.",
        "right is idle.",
        "To move it again: release the user stop.",
        "Started again: nothing.",
    ]


def test_recover_of_all_arms_can_start_controllers_again(run, station):
    outcome = run("recover --restart")

    assert station.calls == [("recover_all", "previous")]
    assert "Started again: arm." in outcome.out


def test_recover_can_start_controllers_again(run, station):
    outcome = run("recover right --restart")

    assert station.calls == [("recover", "right", "previous")]
    assert "Started again: arm." in outcome.out


def test_recover_of_an_arm_without_a_name_is_not_that_of_all(station):
    main(["recover", ""])

    assert station.calls == [("recover", "", "none")]


@pytest.fixture
def watchdog(monkeypatch):
    """Return the list of what the watchdog of the station was asked for."""
    asked = []

    def stop_through_watchdog(url, token, reason):
        asked.append((url, token, reason))
        return WatchdogStop(carried_out=False, detail="It is latched.")

    motion = "station.cli.verbs.motion"
    monkeypatch.setattr(f"{motion}.stop_through_watchdog", stop_through_watchdog)
    monkeypatch.setattr(f"{motion}.watchdog_of", lambda _: "http://127.0.0.1:9")
    return asked


def test_a_station_that_does_not_answer_is_stopped_through_its_watchdog(
    run, station, watchdog
):
    station.refusal = StationUnreachableError("http://x", OSError("timed out"))

    outcome = run("stop --reason smoke")

    assert outcome.code == 0
    assert watchdog == [("http://127.0.0.1:9", "secret", "smoke")]
    assert "through the watchdog. It is latched." in outcome.out
    assert station.timeout == 0.5


def test_a_stop_that_no_cycle_carries_out_goes_through_the_watchdog(
    run, station, watchdog
):
    station.stop = lambda _: StopState(
        state="stopped", reason="", epoch=1, pending=True
    )

    outcome = run("stop --json")

    assert json.loads(outcome.out) == {"state": "stopped", "pending": True}
    assert len(watchdog) == 1


def test_a_station_that_stops_needs_no_watchdog(run, watchdog):
    assert run("stop").code == 0
    assert watchdog == []


def test_without_a_watchdog_an_unconfirmed_stop_is_an_error(run, station):
    station.refusal = StationUnreachableError("http://x", OSError("timed out"))

    assert run("stop").code == 1
