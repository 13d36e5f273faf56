"""The events of a station: who asked for what, and how others follow it."""

import json

import httpx
import pytest

from station.client import ApiError
from station.events import EventKind
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.test_server import open_stream
from tests.waiting import PATIENCE

EVENTS = "/api/v1/events"


@pytest.fixture
def log(app):
    return app.state.services.event_recorder.log


def requests_of(client):
    return [(e.who, e.what, e.result) for e in client.events(kinds=["request"])]


def test_a_change_is_recorded_with_who_did_it(client):
    client.load_controller("spring", "test/Spring", {"joint": "j"})

    (event,) = client.events(kinds=["request"])
    assert (event.who, event.where) == ("operator", "127.0.0.1")
    assert (event.what, event.result) == ("POST /controllers", "201")
    assert event.request_id


def test_a_change_under_a_lease_is_recorded_with_the_name_of_its_owner(spring):
    spring.lease.act_under(spring.lease.take("ada").lease)
    spring.switch_controllers(stop=["spring"])

    assert requests_of(spring)[-1] == (
        "ada (operator)",
        "POST /controllers/switch",
        "200",
    )
    assert spring.events(kinds=["switch"])[-1].who == "ada (operator)"


def test_a_change_of_gains_says_which_and_how_plots_mark_it(spring):
    spring.set_gains("spring", {"k": 8.0})
    event = spring.events(kinds=["request"])[-1]
    assert event.text == "operator changed gains of spring."
    assert event.details == {"mark": "gains k 2 → 8"}
    spring.gain_sets.undo()
    assert spring.events(kinds=["request"])[-1].details == {"mark": "gains undone"}


def test_a_preview_of_a_switch_leaves_no_event(spring):
    before = len(spring.events())
    plan = spring.switch_controllers(stop=["spring"], dry_run=True)
    with pytest.raises(ApiError):
        spring.switch_controllers(start=["unknown"], dry_run=True)

    assert plan.stopped == ["spring"]
    assert len(spring.events()) == before


def test_a_refusal_is_recorded_with_its_code(client):
    with pytest.raises(ApiError):
        client.unload_controller("unknown")

    assert requests_of(client) == [
        ("operator", "DELETE /controllers/unknown", "404 controller_not_found")
    ]
    assert client.events(severity="warning")[0].kind == "request"


def test_a_request_from_another_origin_is_recorded(operator, log):
    operator.post("/api/v1/stop", headers={"Origin": "http://evil.example"})

    (event,) = log.since(kinds=[EventKind.REQUEST])
    assert event.result == "403 origin_not_allowed"


def test_wrong_tokens_are_recorded_and_counted(http, log):
    for _ in range(5):
        http.post("/api/v1/login", json={"token": "guess"})

    assert len(log.since(kinds=[EventKind.LOGIN_FAILED])) == 3


def test_a_login_and_a_logout_are_recorded(http, log):
    http.post("/api/v1/login", json={"token": VIEWER})
    http.post("/api/v1/logout")

    found = [(e.who, e.what) for e in log.since(kinds=[EventKind.LOGIN])]
    assert found == [("viewer", "login"), ("viewer", "logout")]


def test_a_switch_is_recorded_with_what_it_did(spring):
    (event,) = spring.events(kinds=["switch"])

    assert event.result == "committed"
    assert event.details["started"] == ["spring"]


def test_set_points_that_repeat_are_counted_instead(spring, app):
    for _ in range(30):
        spring.command("spring", [0.1])
    app.state.services.event_recorder.repeats.finish()

    events = [e for e in spring.events(kinds=["request"]) if "PUT" in e.what]
    assert [e.details.get("repeated") for e in events] == [None, 29]


def test_events_come_in_pages(client, log):
    for number in range(5):
        log.record(EventKind.STOP, str(number))

    assert [e.text for e in client.events(limit=2)] == ["3", "4"]
    assert [e.text for e in client.events(2, limit=2)] == ["2", "3"]
    assert client.events(5) == []


@pytest.mark.parametrize(
    "query", ["kind=nonsense", "severity=bad", "since=-1", "limit=0", "limit=9999"]
)
def test_a_wrong_question_is_refused(operator, query):
    assert operator.get(f"{EVENTS}?{query}").status_code == 422


def test_they_are_followed_as_server_sent_events(server, log):
    log.record(EventKind.STOP, "one")
    log.record(EventKind.STOP, "two")
    headers = {
        "Authorization": f"Bearer {OPERATOR}",
        "Accept": "text/event-stream",
        "Last-Event-ID": "1",
    }
    with (
        httpx.Client(trust_env=False, headers=headers) as client,
        client.stream("GET", server.url + EVENTS) as answer,
    ):
        lines = answer.iter_lines()
        assert next(lines) == "retry: 1000"
        first = [next(lines) for _ in range(5)]
        log.record(EventKind.FAULT, "three")
        second = [next(lines) for _ in range(4)]

    assert first[1:3] == ["id: 2", "event: stop"]
    assert json.loads(first[3].removeprefix("data: "))["text"] == "two"
    assert second[0:2] == ["id: 3", "event: fault"] or second[1:3] == [
        "id: 3",
        "event: fault",
    ]


def test_too_many_followers_are_turned_away(server, monkeypatch):
    monkeypatch.setattr("station.api.event_feed.MOST_FOLLOWERS", 0)
    headers = {"Authorization": f"Bearer {OPERATOR}", "Accept": "text/event-stream"}

    answer = httpx.get(server.url + EVENTS, headers=headers, trust_env=False)

    assert answer.status_code == 503
    assert answer.json()["code"] == "too_many_streams"


def test_a_stream_has_every_event(server, log):
    with open_stream(server, "events") as stream:
        json.loads(stream.recv(timeout=PATIENCE))
        for number in range(100):
            log.record(EventKind.STOP, str(number))
        frames = [json.loads(stream.recv(timeout=PATIENCE)) for _ in range(100)]

    assert [frame["data"]["text"] for frame in frames] == [str(n) for n in range(100)]
    assert [frame["seq"] for frame in frames] == list(range(1, 101))


def test_status_and_metrics_tell_how_the_log_is_doing(operator, log):
    log.record(EventKind.STOP, "one")

    status = operator.get("/api/v1/status").json()
    assert status["events"] == {"newest_id": 1, "pending": 0, "lost": 0, "failure": ""}
    assert "station_events_lost_total 0.0" in operator.get("/metrics").text
