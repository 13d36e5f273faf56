"""Requests as they travel, and answers as they are read."""

import asyncio
import math
import ssl

import httpx
import pytest
from pydantic import ValidationError

from station.client import ApiError, AsyncStationClient, EmptyNameError, StationClient
from station.client.connection import AsyncConnection, RequestDeadline, segment
from station.core.clock import ManualClock
from station.wire import Session
from station.wire.protocol import CLOCK_HEADER, NOT_AFTER_HEADER
from tests.client.recorder import Recorder

CONTROLLER = {
    "name": "a",
    "type": "t/T",
    "state": "initialized",
    "claimed_resources": [],
    "fault": None,
    "traceback": None,
    "fallback": [],
    "time": {"p50": 0.0, "p99": 0.0, "p999": 0.0, "max": 0.0, "count": 0},
}
CHANGE = {"values": {}, "previous": {}, "revision": 1, "cycle": 1}


def test_names_are_quoted():
    recorder = Recorder(CONTROLLER)

    recorder.run(lambda client: client.controller("a/b c"))

    assert recorder.requests == [("GET", "/api/v1/controllers/a%2Fb%20c", None)]


@pytest.mark.parametrize(
    ("arguments", "body"),
    [
        (("a",), {"name": "a"}),
        (("a", "t/T", {"p": 1}), {"name": "a", "type": "t/T", "params": {"p": 1}}),
    ],
)
def test_only_what_was_given_is_sent(arguments, body):
    recorder = Recorder(CONTROLLER)

    recorder.run(lambda client: client.load_controller(*arguments))

    assert recorder.requests == [("POST", "/api/v1/controllers", body)]
    assert recorder.headers[0]["Content-Type"] == "application/json"


@pytest.mark.parametrize("etag", ['"x"', None])
def test_an_etag_becomes_if_match(etag):
    recorder = Recorder(CHANGE)

    recorder.run(lambda client: client.set_gains("a", {"p": 1.0}, etag))

    assert recorder.headers[0].get("If-Match") == etag


def test_a_request_without_a_body_has_no_content_type():
    recorder = Recorder({"role": "viewer"})

    assert recorder.run(lambda client: client.session()).role == "viewer"
    assert "Content-Type" not in recorder.headers[0]


def test_an_answer_that_is_no_problem_document_is_quoted():
    recorder = Recorder("Bad gateway", status=502)

    with pytest.raises(ApiError, match="answered 502"):
        recorder.run(lambda client: client.session())


@pytest.mark.parametrize("value", [math.nan, math.inf, "0.5", True])
def test_a_value_that_is_not_a_finite_number_is_not_even_sent(value):
    recorder = Recorder(CHANGE)

    with pytest.raises(ValidationError):
        recorder.run(lambda client: client.command("a", [value]))
    with pytest.raises(ValidationError):
        recorder.run(lambda client: client.set_gains("a", {"p": value}))
    assert recorder.requests == []


def test_a_mapping_with_a_number_that_is_not_finite_is_not_even_sent():
    recorder = Recorder({"role": "viewer"})

    transport = httpx.MockTransport(recorder.answer)
    connection = AsyncConnection("http://station", None, 1.0, transport)

    body = {"steps": [{"kind": "goal", "values": [0.0, math.inf]}]}
    with pytest.raises(ValueError, match=r"^steps/0/values/1 is inf; it must be a fin"):
        asyncio.run(connection.send("POST", "/session", Session, body))
    assert recorder.requests == []


def test_a_slash_at_the_end_of_the_address_does_not_matter():
    assert AsyncStationClient("http://127.0.0.1:8000/").url == "http://127.0.0.1:8000"


def test_authorities_are_read_for_https_alone(monkeypatch):
    # It takes 50 ms, which every verb and every stop would wait.
    def read(*_args, **_options):
        raise LookupError("the authorities of the system")

    monkeypatch.setattr(ssl, "create_default_context", read)
    StationClient("http://localhost:1", "token").close()
    asyncio.run(AsyncStationClient("http://localhost:1", "token").close())
    with pytest.raises(LookupError):
        StationClient("https://station.example:1", "token")


def test_a_client_moves_to_another_station():
    seen = []

    def answer(request):
        seen.append((request.url.host, request.headers.get("Authorization")))
        return httpx.Response(200, json={"role": "viewer"})

    async def ask():
        transport = httpx.MockTransport(answer)
        async with AsyncStationClient("http://old", "a", transport=transport) as client:
            await client.session()
            client.talk_to("http://new/", "b")
            await client.session()
            client.talk_to("http://open", None)
            await client.session()
            return client.url, client.stream("loop").options.token

    assert asyncio.run(ask()) == ("http://open", None)
    assert seen == [("old", "Bearer a"), ("new", "Bearer b"), ("open", None)]


def test_the_timeout_can_be_changed():
    seen = []

    def answer(request):
        seen.append(request.extensions["timeout"]["read"])
        return httpx.Response(200, json={"role": "viewer"})

    async def ask():
        transport = httpx.MockTransport(answer)
        async with AsyncStationClient(
            "http://a", "t", transport=transport, timeout=3.0
        ) as client:
            await client.session()
            client.timeout = 0.5
            await client.session()

    asyncio.run(ask())
    assert seen == [3.0, 0.5]


def test_a_change_may_begin_for_some_time_by_the_stations_clock():
    clock = ManualClock()
    prompt = RequestDeadline(3.0, clock.now)
    assert prompt.headers() == {}
    prompt.hear({CLOCK_HEADER: "1000.25"})
    clock.advance(2.0)
    prompt.hear({})
    prompt.hear({CLOCK_HEADER: "1000.5"})  # read late
    assert prompt.headers() == {NOT_AFTER_HEADER: "1005.250"}
    for _ in range(20):  # The station's clock was put back.
        prompt.hear({CLOCK_HEADER: "900.0"})
    assert prompt.headers() == {NOT_AFTER_HEADER: "903.000"}


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("arm", "arm"),
        ("a/b c", "a%2Fb%20c"),
        ("x&y?", "x%26y%3F"),
        ("a.b-c_1", "a.b-c_1"),
        ("..", "%2E%2E"),
    ],
)
def test_a_name_is_one_segment_of_a_path(name, written):
    assert segment(name) == written


def test_an_empty_name_is_refused_before_anything_is_sent():
    with pytest.raises(EmptyNameError, match="must have at least 1 character"):
        segment("")
