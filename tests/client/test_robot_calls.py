"""The routes of an arm as values."""

from station.client import robot_calls as calls
from station.wire import ExternalForce


def test_names_are_quoted():
    assert calls.state("a/b").path == "/api/v1/robots/a%2Fb/state"
    assert calls.model("a", "x&y").path.endswith("/a/model?frame=x%26y")


def test_only_what_was_set_is_sent():
    call = calls.send("POST", "a", "external_force", ExternalForce(link="hand"))
    assert call.body == b'{"link":"hand"}'
    assert calls.send("PUT", "a", "load", {"mass": 1.0}).body == b'{"mass":1.0}'


def test_recovery_says_what_shall_restart():
    call = calls.recover("a", "previous")
    assert (call.method, call.body) == ("POST", b'{"restart":"previous"}')
