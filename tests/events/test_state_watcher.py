"""What the watcher notices in a station."""

import pytest

from station.core.control.switching import SwitchRequest
from station.core.franka import RobotMode
from station.core.franka.arms import ArmReport
from station.events.event_log import EventLog
from station.events.state_watcher import CALM, QUIET, StateWatcher
from station.reports import EventKind, Severity


@pytest.fixture
def log():
    return EventLog()


@pytest.fixture
def watcher(station, log):
    watcher = StateWatcher(station, log)
    watcher.look()
    return watcher


def told(log, kind):
    return [(e.what, e.result) for e in log.since(kinds=[kind])]


def test_a_look_at_a_station_that_stays_as_it_is_records_nothing(log, watcher):
    before = log.newest_id
    watcher.look()

    assert log.newest_id == before


def test_a_stop_and_its_release_are_recorded(station, log, watcher):
    station.stop("Somebody is in the cell.")
    station.loop.step()
    watcher.look()
    station.release_stop(arm=False)
    watcher.look()
    station.release_stop(arm=True)
    watcher.look()

    assert [result for _, result in told(log, EventKind.STOP)] == [
        "stopped",
        "released",
        "armed",
    ]
    assert "Somebody is in the cell." in log.since(kinds=[EventKind.STOP])[0].text


def test_controllers_are_followed_from_loading_to_unloading(
    station, log, watcher, load_spring
):
    load_spring()
    watcher.look()
    station.switch_controllers(SwitchRequest(start=("spring",)))
    watcher.look()
    station.switch_controllers(SwitchRequest(stop=("spring",)))
    watcher.look()
    station.unload_controller("spring")
    watcher.look()

    found = told(log, EventKind.CONTROLLER)
    assert [name for name, _ in found] == ["spring"] * 4
    assert found[1] == ("spring", "running")
    assert found[3] == ("spring", "unloaded")


def test_a_fault_is_recorded_with_its_traceback(log, watcher, break_spring):
    break_spring()
    watcher.look()

    (event,) = log.since(kinds=[EventKind.FAULT])
    assert "a broken spring" in event.text
    assert "RuntimeError" in event.details["traceback"]
    assert event.severity is Severity.ERROR


def test_missed_deadlines_close_to_each_other_are_one_event(station, log, watcher):
    clock, meter = station.loop.clock, station.loop._meter
    for missed in (3, 4):
        meter.woke(0.0, missed)
        watcher.look()
        clock.advance(0.5 * QUIET)
        watcher.look()
    clock.advance(QUIET)
    watcher.look()
    meter.woke(0.0, 1)
    watcher.look()
    clock.advance(2.0 * QUIET)
    watcher.look()

    (event,) = log.since(kinds=[EventKind.OVERRUN])
    assert event.details["missed"] == 7
    assert "station doctor" in event.text


def test_bursts_that_go_on_are_told_seldom_with_all_they_missed(station, log, watcher):
    clock, meter = station.loop.clock, station.loop._meter

    def miss(seconds):
        for _ in range(seconds // 3):
            meter.woke(0.0, 10)
            watcher.look()
            clock.advance(3.0)
            watcher.look()

    miss(3600)
    events = log.since(kinds=[EventKind.OVERRUN])
    assert len(events) == 4  # at once, after 1, 5 and 21 minutes
    assert sum("station doctor" in event.text for event in events) == 1
    assert events[1].text.startswith(
        "The control loop missed 200 deadlines in 20 more bursts within 60 s."
    )
    watcher.stop()
    events = log.since(kinds=[EventKind.OVERRUN])
    assert sum(event.details["missed"] for event in events) == 12000

    clock.advance(CALM)
    miss(3)
    last = log.since(kinds=[EventKind.OVERRUN])[-1]
    assert last.text == "The control loop missed 10 deadlines in a burst."


def test_a_look_that_fails_is_told_once_and_the_others_go_on(
    station, log, monkeypatch, caplog
):
    looks = []
    watcher = StateWatcher(station, log, {"looks": lambda: looks.append(1)})

    def fail():
        raise RuntimeError("a list that changed its size")

    with monkeypatch.context() as patch:
        patch.setattr(station.manager, "conditions", fail)
        station.stop("now")
        watcher.look()
        watcher.look()
    assert told(log, EventKind.EVENTS) == [("the controllers", "failed")]
    assert told(log, EventKind.STOP) == [("", "stopped")]
    assert len(looks) == 2
    assert caplog.text.count("a list that changed its size") >= 1
    assert caplog.text.count("cannot be watched") == 1

    watcher.look()
    monkeypatch.setattr(station.manager, "conditions", fail)
    watcher.look()
    assert len(told(log, EventKind.EVENTS)) == 2


def test_the_thread_looks_and_ends(station, log):
    watcher = StateWatcher(station, log)
    watcher.start()
    station.stop("now")
    watcher.stop()

    assert told(log, EventKind.STOP) == [("", "stopped")]


def test_mode_in_which_an_arm_cannot_move_is_an_error_with_its_remedy(
    station, log, watcher, monkeypatch
):
    todo = "restore the connection, then recover"
    report = ArmReport(
        "left", RobotMode.OTHER, is_connected=True, errors=(), remedy=todo
    )
    monkeypatch.setattr(watcher._arms, "reports", lambda: [report])
    station.loop.hw.present_mode = "other"
    station.loop.step()
    watcher.look()

    event = log.since(kinds=[EventKind.ROBOT_MODE])[-1]
    assert event.severity is Severity.ERROR
    assert event.details["remedies"] == [f"left: {todo}"]


def test_the_end_and_the_return_of_the_watchdog_are_recorded(station, log, watcher):
    for failure in ("It is suspended.", None):
        station.watchdog_failure = failure
        watcher.look()
        watcher.look()

    found = told(log, EventKind.WATCHDOG)
    assert [result for _, result in found] == ["failed", "watching"]
