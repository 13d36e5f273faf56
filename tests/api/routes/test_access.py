"""Logging in and out, and tickets."""

import pytest

from station.web.failed_logins import FailedLogins
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.test_errors import problem_of


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
