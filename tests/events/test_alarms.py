"""What alarms, how long, and who has seen it."""

import pytest

from station.events import AlarmNotFoundError, Alarms, EventKind, EventLog, Origin


@pytest.fixture
def wall():
    """The wall time, in a list of one."""
    return [100.0]


@pytest.fixture
def log(wall):
    return EventLog(now=lambda: wall[0])


@pytest.fixture
def alarms(station, log):
    return Alarms(station, log)


def stop(station, reason="Somebody is in the cell."):
    station.stop(reason)
    station.loop.step()


def allow(station):
    station.release_stop(arm=False)
    station.release_stop(arm=True)


def test_a_station_without_trouble_has_no_alarms(alarms):
    assert alarms.all() == []


def test_a_stop_alarms_until_it_is_released_and_was_seen(station, alarms, wall):
    stop(station)
    (alarm,) = alarms.all()
    assert (alarm.id, alarm.cause.subject, alarm.raised_at) == (1, "stop", 100.0)
    assert "Somebody is in the cell." in alarm.cause.text
    wall[0] = 101.0
    allow(station)
    assert alarms.all()[0].cleared_at == 101.0
    alarms.acknowledge(1, Origin("ada"))
    assert alarms.all() == []


def test_an_acknowledged_alarm_stays_while_its_cause_does(station, alarms, log):
    stop(station)
    alarms.look()
    seen = alarms.acknowledge(1, Origin("ada"))
    assert (seen.acknowledged_by, seen.acknowledged_at) == ("ada", 100.0)
    assert alarms.acknowledge(1, Origin("bob")) == seen
    assert alarms.all() == [seen]
    (event,) = log.since(kinds=[EventKind.ALARM])
    assert (event.who, event.what, event.result) == ("ada", "stop", "acknowledged")
    allow(station)
    assert alarms.all() == []


def test_a_cause_that_returns_is_a_new_alarm(station, alarms):
    stop(station)
    alarms.look()
    allow(station)
    alarms.look()
    stop(station)
    assert [alarm.id for alarm in alarms.all()] == [2, 1]


def test_another_cause_of_the_same_subject_asks_to_be_seen_again(station, alarms):
    stop(station, "First.")
    alarms.look()
    stop(station, "Second.")
    (alarm,) = alarms.all()
    assert (alarm.id, alarm.cause.text) == (1, "The station is stopped: Second.")
    alarms.acknowledge(1)
    stop(station, "Third.")
    (alarm,) = alarms.all()
    assert (alarm.id, alarm.acknowledged_at) == (2, None)


def test_an_alarm_that_is_not_there_cannot_be_acknowledged(alarms):
    with pytest.raises(AlarmNotFoundError, match="no alarm 7"):
        alarms.acknowledge(7)


def test_a_faulty_controller_alarms_until_it_is_unloaded(station, alarms, break_spring):
    break_spring()
    (alarm,) = alarms.all()
    assert alarm.cause.subject == "controller spring"
    assert "a broken spring" in alarm.cause.text
    station.unload_controller("spring")
    assert alarms.all()[0].cleared_at is not None


def test_a_watchdog_that_does_not_look_alarms(station, alarms):
    station.watchdog_failure = "It is suspended."
    (alarm,) = alarms.all()
    station.watchdog_failure = None

    assert (alarm.cause.subject, alarm.cause.text) == ("watchdog", "It is suspended.")
    assert alarms.all()[0].cleared_at is not None
