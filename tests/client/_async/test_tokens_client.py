"""Requests of the client of named tokens."""

from tests.client.recorder import Recorder

TOKEN = {"name": "ada", "role": "viewer", "created": 1.0, "expires_at": None}


def test_requests_of_tokens():
    recorder = Recorder({**TOKEN, "token": "secret", "tokens": [TOKEN]})

    recorder.run(lambda client: client.tokens.list())
    recorder.run(lambda client: client.tokens.create("ada", "viewer", expires=60.0))
    recorder.run(lambda client: client.tokens.revoke("ada"))

    assert recorder.requests == [
        ("GET", "/api/v1/tokens", None),
        (
            "POST",
            "/api/v1/tokens",
            {"name": "ada", "role": "viewer", "expires": 60.0},
        ),
        ("DELETE", "/api/v1/tokens/ada", None),
    ]
