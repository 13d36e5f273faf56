"""The wire model of alarms."""

from station.wire import Alarm, Alarms

SEEN = {
    "id": 3,
    "subject": "stop",
    "severity": "warning",
    "text": "The station is stopped.",
    "remedy": "Release the stop.",
    "raised_at": 1.0,
    "cleared_at": None,
    "acknowledged_by": "ada",
    "acknowledged_at": 2.0,
}


def test_an_alarm_travels_unchanged():
    alarms = Alarms.model_validate({"alarms": [SEEN], "unacknowledged": 0})

    assert alarms.alarms == [Alarm.model_validate(SEEN)]
    assert alarms.model_dump(mode="json")["alarms"] == [SEEN]
