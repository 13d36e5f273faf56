"""Named tokens over HTTP."""

import pytest
from websockets.exceptions import ConnectionClosed

from station.client import ApiError, StationClient
from tests.api.conftest import URL, AppTransport
from tests.api.test_server import open_stream
from tests.waiting import PATIENCE

TOKENS = "/api/v1/tokens"


def as_bearer(app, token):
    return StationClient(URL, token, transport=AppTransport(app))


def test_a_named_token_does_what_its_role_may(client, app):
    made = client.tokens.create("ada", "viewer", expires=3600.0)

    with as_bearer(app, made.token) as ada:
        session = ada.session()
        assert (session.name, session.role) == ("ada", "viewer")
        ada.stop("by ada")
        with pytest.raises(ApiError) as refused:
            ada.release_stop()
    assert refused.value.status == 403
    assert client.events(kinds=["request"])[1].who == "ada"


def test_tokens_are_listed_without_their_secret(client, operator):
    secret = client.tokens.create("ada").token

    assert [token.name for token in client.tokens.list()] == ["ada"]
    assert secret not in operator.get(TOKENS).text


def test_a_revoked_token_is_unknown(client, app):
    made = client.tokens.create("ada")
    client.tokens.revoke("ada")

    with as_bearer(app, made.token) as ada, pytest.raises(ApiError) as refused:
        ada.status()
    assert refused.value.status == 401
    assert [e.result for e in client.events(kinds=["token"])] == ["created", "revoked"]


def test_a_named_token_makes_no_tokens(client, app):
    made = client.tokens.create("ada")

    with as_bearer(app, made.token) as ada, pytest.raises(ApiError) as refused:
        ada.tokens.create("eve")
    assert refused.value.code == "own_token_needed"


def test_revocation_ends_open_streams_and_sessions(live, server):
    made = live.tokens.create("ada")
    headers = {"Authorization": f"Bearer {made.token}"}
    with open_stream(server, "loop", headers) as stream:
        stream.recv(timeout=PATIENCE)
        live.tokens.revoke("ada")
        with pytest.raises(ConnectionClosed) as closed:
            list(stream)
    assert closed.value.rcvd.code == 4401


def test_a_session_ends_with_the_token_that_opened_it(client, http):
    made = client.tokens.create("ada")
    http.headers.pop("Authorization", None)
    http.post("/api/v1/login", json={"token": made.token})
    assert http.get("/api/v1/session").json()["name"] == "ada"

    client.tokens.revoke("ada")
    assert http.get("/api/v1/session").status_code == 401


@pytest.mark.parametrize(
    "body",
    [{"name": ""}, {"name": "a/b"}, {"name": "a", "role": "root"}, {"expires": 1.0}],
)
def test_malformed_tokens_are_refused(operator, body):
    assert operator.post(TOKENS, json=body).status_code == 422
