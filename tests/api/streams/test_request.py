"""What may be asked of a stream."""

import pytest

from station.api.streams import StreamRequest, StreamRequestError
from station.api.streams.request import parse_request
from station.api.streams.topics import topic_names
from station.events import EventLog
from station.wire import CLOSE_BAD_REQUEST, CLOSE_UNKNOWN_TOPIC
from tests.api.spring import make_station


@pytest.fixture
def station():
    station = make_station()
    station.load_controller("spring", "test/Spring", {"joint": "j"})
    return station


def test_a_stream_has_defaults(station):
    request, topic = parse_request(station, "joint_states", {})

    assert request == StreamRequest("joint_states", 30.0, frozenset(), "json")
    assert topic.name == "joint_states"


def test_everything_can_be_chosen(station):
    query = {
        "rate": "12.5",
        "fields": "error,stamp",
        "format": "msgpack",
        "ticket": "x",
    }

    request, _ = parse_request(station, "controller_state/spring", query)

    assert request == StreamRequest(
        "controller_state/spring", 12.5, frozenset({"error", "stamp"}), "msgpack"
    )


def test_every_cycle_of_every_topic_can_be_asked_for(station):
    for name in set(topic_names(station)) - {"events"}:
        request, _ = parse_request(station, name, {"rate": "full"})

        assert request.rate is None


def test_every_event_comes_at_any_rate_and_at_the_full_one(station):
    for query in ({}, {"rate": "full"}):
        assert parse_request(station, "events", query, EventLog())[0].rate == 20.0


def test_fields_of_a_sample_can_be_chosen(station):
    query = {"rate": "full", "fields": "period"}

    request, _ = parse_request(station, "loop", query)

    assert request.fields == {"period"}


@pytest.mark.parametrize(
    ("name", "query", "code"),
    [
        ("nothing", {}, CLOSE_UNKNOWN_TOPIC),
        ("", {}, CLOSE_UNKNOWN_TOPIC),
        ("controller_state/nobody", {}, CLOSE_UNKNOWN_TOPIC),
        ("controller_state/", {}, CLOSE_UNKNOWN_TOPIC),
        ("x" * 3000, {}, CLOSE_UNKNOWN_TOPIC),
        ("joint_states", {"rate": "0"}, CLOSE_BAD_REQUEST),
        ("joint_states", {"rate": "-1"}, CLOSE_BAD_REQUEST),
        ("joint_states", {"rate": "1e9"}, CLOSE_BAD_REQUEST),
        ("joint_states", {"rate": "nan"}, CLOSE_BAD_REQUEST),
        ("joint_states", {"rate": "inf"}, CLOSE_BAD_REQUEST),
        ("joint_states", {"rate": "fast" * 99}, CLOSE_BAD_REQUEST),
        ("joint_states", {"rate": ""}, CLOSE_BAD_REQUEST),
        ("loop", {"rate": "full", "fields": "loop"}, CLOSE_BAD_REQUEST),
        ("joint_states", {"fields": "position,tau"}, CLOSE_BAD_REQUEST),
        ("joint_states", {"format": "xml"}, CLOSE_BAD_REQUEST),
        ("joint_states", {"speed": "1"}, CLOSE_BAD_REQUEST),
    ],
)
def test_what_cannot_be_had_is_refused_with_a_reason(station, name, query, code):
    with pytest.raises(StreamRequestError) as caught:
        parse_request(station, name, query)

    assert caught.value.close_code == code
    assert 0 < len(caught.value.reason.encode()) <= 123


def test_an_unknown_topic_lists_the_known(station):
    with pytest.raises(StreamRequestError, match=r"joint_states.*controller_state/spr"):
        parse_request(station, "nothing", {})
