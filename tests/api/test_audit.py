"""The audit names who is behind a request; `routes/test_events.py` tries the rest."""

from starlette.requests import HTTPConnection

from station.api.audit import WHO, origin_of


def connection(state):
    return HTTPConnection({
        "type": "http",
        "headers": [],
        "client": ("10.0.0.7", 40000),
        "state": state,
    })


def test_a_request_that_proved_its_access_has_a_name():
    origin = origin_of(connection({WHO: "viewer"}))

    assert (origin.who, origin.where) == ("viewer", "10.0.0.7")


def test_a_request_that_proved_nothing_has_an_address_alone():
    origin = origin_of(connection({}))

    assert (origin.who, origin.where) == ("", "10.0.0.7")
