"""Alarms over HTTP."""

import pytest

from station.client import ApiError


def test_a_stop_alarms_and_is_acknowledged(client):
    client.stop("Somebody is in the cell.")
    (alarm,) = client.alarms.list()
    assert alarm.subject == "stop"
    assert alarm.acknowledged_at is None
    assert "release the stop" in alarm.remedy

    seen = client.alarms.acknowledge(alarm.id)

    assert (seen.id, seen.acknowledged_by) == (alarm.id, "operator")
    assert client.alarms.list() == [seen]
    (event,) = client.events(kinds=["alarm"])
    assert (event.who, event.what) == ("operator", "stop")


def test_an_unknown_alarm_is_refused(client):
    with pytest.raises(ApiError) as caught:
        client.alarms.acknowledge(9)

    assert (caught.value.status, caught.value.code) == (404, "alarm_not_found")


def test_a_viewer_sees_alarms_and_acknowledges_none(client, http):
    client.stop()
    http.headers["Authorization"] = "Bearer viewer-token"

    assert http.get("/api/v1/alarms").json()["unacknowledged"] == 1
    assert http.post("/api/v1/alarms/1/acknowledge").status_code == 403
