"""Requests as they travel."""

import json
import math

import pytest
from pydantic import ValidationError

from station.client import ApiError, calls
from station.wire import SwitchRequest


def test_names_are_quoted():
    assert calls.controller("a/b c").path == "/api/v1/controllers/a%2Fb%20c"
    assert calls.gains("..").path == "/api/v1/controllers/../gains"


def test_only_what_was_given_is_sent():
    call = calls.load_controller("a", None, None)
    assert json.loads(call.body) == {"name": "a"}

    call = calls.load_controller("a", "t/T", {"p": 1})
    assert json.loads(call.body) == {"name": "a", "type": "t/T", "params": {"p": 1}}


def test_a_switch_may_take_its_time():
    request = SwitchRequest(start=["a"], timeout=7.0)

    call = calls.switch_controllers(request)

    assert call.patience == 7.0
    assert json.loads(call.body) == {"start": ["a"], "timeout": 7.0}


def test_a_body_is_sent_as_json_and_nothing_as_nothing():
    assert calls.status().sent_headers() == {}
    sent = calls.set_gains("a", {"p": 1.0}, '"x"').sent_headers()
    assert sent == {"If-Match": '"x"', "Content-Type": "application/json"}


def test_a_refusal_is_an_error_and_an_answer_is_what_was_asked_for():
    assert calls.session().read_answer(200, b'{"role": "viewer"}').role == "viewer"
    with pytest.raises(ApiError, match="answered 502"):
        calls.session().read_answer(502, b"Bad gateway")


def test_an_etag_becomes_if_match():
    assert calls.set_gains("a", {"p": 1.0}, '"x"').headers == {"If-Match": '"x"'}
    assert calls.set_gains("a", {"p": 1.0}, None).headers == {}


@pytest.mark.parametrize("value", [math.nan, math.inf, "0.5", True, None])
def test_what_is_no_number_is_not_even_sent(value):
    with pytest.raises(ValidationError):
        calls.command("a", [value], None, None)
    with pytest.raises(ValidationError):
        calls.set_gains("a", {"p": value}, None)


@pytest.mark.parametrize(
    "call",
    [
        calls.health(),
        calls.ready(),
        calls.status(),
        calls.controllers(),
        calls.controller("spring"),
        calls.unload_controller("spring"),
        calls.gains("spring"),
        calls.last_command("spring"),
        calls.command("spring", [0.0], None, None),
        calls.controller_state("spring"),
        calls.joint_states(),
        calls.controller_types(),
        calls.loop(),
        calls.reset_loop_statistics(),
        calls.stop_state(),
        calls.stop(""),
        calls.release_stop(arm=False),
        calls.stream_ticket(),
    ],
)
def test_every_call_has_a_path_under_the_version(call):
    assert call.path.startswith("/api/v1/")
    assert (call.body is None) == (call.method in {"GET", "DELETE"}) or not call.body
