"""Requests of the client of alarms."""

from tests.client.recorder import Recorder

ALARM = {
    "id": 3,
    "subject": "stop",
    "severity": "warning",
    "text": "The station is stopped.",
    "remedy": "Release the stop.",
    "raised_at": 1.0,
    "cleared_at": None,
    "acknowledged_by": "",
    "acknowledged_at": None,
}


def test_alarms_are_listed_and_acknowledged():
    recorder = Recorder({"alarms": [ALARM], "unacknowledged": 1})
    assert recorder.run(lambda client: client.alarms.list())[0].id == 3
    assert recorder.requests == [("GET", "/api/v1/alarms", None)]
    recorder = Recorder(ALARM)
    assert recorder.run(lambda client: client.alarms.acknowledge(3)).id == 3
    assert recorder.requests == [("POST", "/api/v1/alarms/3/acknowledge", None)]
