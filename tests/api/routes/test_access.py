"""Logging in and out, and tickets."""

import pytest
from websockets.exceptions import ConnectionClosed

from station.client import ApiError, StationClient
from station.web.failed_logins import FailedLogins
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.api.test_errors import problem_of
from tests.api.test_server import open_stream
from tests.waiting import PATIENCE


@pytest.mark.parametrize(
    ("token", "role"), [(OPERATOR, "operator"), (VIEWER, "viewer")]
)
def test_a_token_is_exchanged_for_a_cookie(http, token, role):
    answer = http.post("/api/v1/login", json={"token": token})

    assert answer.json() == {"role": role, "name": role}
    cookie = answer.headers["set-cookie"].lower()
    assert "httponly" in cookie
    assert "samesite=strict" in cookie
    assert token not in cookie
    assert http.get("/api/v1/session").json() == {"role": role, "name": role}


def test_logging_out_makes_the_cookie_worthless(http):
    http.post("/api/v1/login", json={"token": OPERATOR})
    cookies = dict(http.cookies)

    assert http.post("/api/v1/logout").status_code == 204
    assert dict(http.cookies) == {}
    http.cookies.update(cookies)
    problem_of(http.get("/api/v1/session"), 401, "unauthorized")


def test_a_wrong_token_gets_no_cookie(http):
    answer = http.post("/api/v1/login", json={"token": "wrong"})

    problem_of(answer, 401, "unauthorized")
    assert "set-cookie" not in answer.headers


def test_the_printed_link_logs_in_and_leads_on(http):
    answer = http.get("/login", params={"token": OPERATOR})

    assert answer.status_code == 303
    assert answer.headers["location"] == "/docs"
    assert http.get("/api/v1/session").json() == {
        "role": "operator",
        "name": "operator",
    }


@pytest.mark.parametrize(
    ("target", "location"),
    [
        ("/api/v1/status", "/api/v1/status"),
        ("http://evil.example/", "/docs"),
        ("//evil.example/", "/docs"),
        ("/\\evil.example/", "/docs"),
        ("/\t/evil.example/", "/%09/evil.example/"),
        ("javascript:alert(1)", "/docs"),
    ],
)
def test_the_link_leads_nowhere_else(http, target, location):
    answer = http.get("/login", params={"token": OPERATOR, "next": target})

    assert answer.headers["location"] == location


def test_the_link_with_a_wrong_token_is_refused(http):
    problem_of(http.get("/login", params={"token": "x"}), 401, "unauthorized")


def test_a_ticket_has_the_role_of_who_asked(client, authenticator):
    ticket = client.stream_ticket()

    assert ticket.expires_in > 0
    assert authenticator.redeem_ticket(ticket.ticket).role.value == "operator"


@pytest.mark.parametrize(
    "guess",
    [
        lambda http: http.post("/api/v1/login", json={"token": "wrong"}),
        lambda http: http.get("/login", params={"token": "wrong"}),
        lambda http: http.get("/api/v1/status", headers={"Authorization": "Bearer no"}),
    ],
    ids=["login", "link", "bearer"],
)
def test_wrong_tokens_are_held_back_and_right_ones_are_not(app, http, guess):
    slept = []

    async def sleep(delay):
        slept.append(delay)

    app.state.services.failed_logins = FailedLogins(sleep=sleep)
    for _ in range(6):
        assert guess(http).status_code == 401
    assert slept == [0.1, 0.2, 0.4]

    assert http.post("/api/v1/login", json={"token": OPERATOR}).status_code == 200
    bearer = {"Authorization": f"Bearer {VIEWER}"}
    assert http.post("/api/v1/stop", headers=bearer).status_code == 200
    assert slept == [0.1, 0.2, 0.4]


def test_requests_without_a_token_are_no_failed_logins(app, http):
    slept = []

    async def sleep(delay):
        slept.append(delay)

    app.state.services.failed_logins = FailedLogins(sleep=sleep)
    for _ in range(6):
        assert http.get("/api/v1/status").status_code == 401
    assert slept == []


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
