"""Address and messages of a command stream."""

import json
import math

import pytest

from station.client.command_options import CommandOptions, written


def test_the_address_names_the_controller_and_the_timeout():
    options = CommandOptions("https://lab:8000", "t", "key", "a/b", 0.5)

    path = "/api/v1/streams/command/a%2Fb?timeout=0.5"
    assert options.url() == f"wss://lab:8000{path}"
    assert options.headers() == {
        "Authorization": "Bearer t",
        "X-Control-Lease": "key",
    }


def test_a_message_has_what_is_known_alone():
    assert json.loads(written([0.5], None, None)) == {"command": [0.5]}
    assert json.loads(written((1,), 3, [2.0])) == {
        "command": [1],
        "epoch": 3,
        "rates": [2.0],
    }


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_what_is_not_finite_is_not_sent(number):
    with pytest.raises(ValueError, match="finite"):
        written([number], None, None)
