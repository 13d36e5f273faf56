"""Addresses, back-off, and which ends of a stream are final."""

import pytest
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.frames import Close
from websockets.http11 import Response

from station.client.stream_options import (
    FIRST_DELAY,
    LONGEST_DELAY,
    Backoff,
    StreamOptions,
    StreamProgress,
    bearer,
    refusal,
)


@pytest.mark.parametrize(
    ("options", "url"),
    [
        (("http://h:1", None, "loop"), "ws://h:1/api/v1/streams/loop"),
        (("https://h", None, "loop", 5), "wss://h/api/v1/streams/loop?rate=5"),
        (
            ("http://h", None, "controller_state/a b", "full", ("x", "y")),
            "ws://h/api/v1/streams/controller_state/a%20b?rate=full&fields=x%2Cy",
        ),
    ],
)
def test_the_url_of_a_stream(options, url):
    assert StreamOptions(*options).url() == url


def test_a_token_is_never_in_the_url():
    options = StreamOptions("http://h", "secret", "loop")

    assert "secret" not in options.url()
    assert bearer("secret") == {"Authorization": "Bearer secret"}
    assert bearer(None) == {}


def test_the_back_off_doubles_up_to_its_limit_and_starts_over():
    backoff = Backoff()
    delays = [backoff.next() for _ in range(12)]

    assert 0.5 * FIRST_DELAY <= delays[0] <= FIRST_DELAY
    assert 0.5 * LONGEST_DELAY <= delays[-1] <= LONGEST_DELAY
    backoff.reset()
    assert backoff.next() <= FIRST_DELAY


def test_hello_is_kept_and_its_boot_id_is_in_every_frame():
    progress = StreamProgress()
    assert progress.snapshot() == {}

    hello = '"topic":"hello","seq":0,"epoch":1,"stamp":0.1,"boot_id":"b","data":{"a":1}'
    assert progress.accept(f"{{{hello}}}") is None
    assert progress.connected
    assert progress.snapshot() == {"a": 1}

    frame = progress.accept('{"topic":"loop","seq":1,"epoch":1,"stamp":0.2,"data":{}}')
    assert (frame.topic, frame.boot_id) == ("loop", "b")


@pytest.mark.parametrize(
    ("final", "code"),
    [
        *((True, code) for code in (4400, 4401, 4403, 4404)),
        *((False, code) for code in (1001, 1006, 1011, 1013, 4408)),
    ],
)
def test_only_refusals_are_final(code, final):
    error = ConnectionClosedError(Close(code, "why") if code != 1006 else None, None)

    refused = refusal(error)

    assert (refused is not None) is final
    if refused is not None:
        assert refused.status == code
        assert str(refused).startswith("why")
        assert refused.remedy


@pytest.mark.parametrize(("status", "final"), [(404, True), (403, True), (503, False)])
def test_a_refused_handshake_is_final_unless_the_server_is_to_blame(status, final):
    error = InvalidStatus(Response(status, "x", Headers(), b"no station"))

    assert (refusal(error) is not None) is final


def test_a_broken_line_is_not_final():
    assert refusal(ConnectionRefusedError()) is None
