"""Tokens, cookies and tickets."""

import pytest

from station.api.auth import (
    MAX_GRANTS,
    SESSION_LIFETIME,
    TICKET_LIFETIME,
    Authenticator,
    Role,
)
from station.core.clock import ManualClock


@pytest.fixture
def clock():
    return ManualClock()


@pytest.fixture
def authenticator(clock):
    return Authenticator("op", "view", clock=clock)


def test_an_operator_may_do_what_a_viewer_may_but_not_the_other_way_round():
    assert Role.OPERATOR.includes(Role.VIEWER)
    assert Role.OPERATOR.includes(Role.OPERATOR)
    assert Role.VIEWER.includes(Role.VIEWER)
    assert not Role.VIEWER.includes(Role.OPERATOR)


def test_tokens_are_random_and_differ():
    one, other = Authenticator(), Authenticator()

    tokens = {
        one.operator_token,
        one.viewer_token,
        other.operator_token,
        other.viewer_token,
    }
    assert len(tokens) == 4
    assert min(len(token) for token in tokens) >= 32


@pytest.mark.parametrize(
    ("header", "role"),
    [
        ("Bearer op", Role.OPERATOR),
        ("bearer op", Role.OPERATOR),
        ("Bearer view", Role.VIEWER),
        ("Bearer nonsense", None),
        ("Bearer ", None),
        ("Bearer", None),
        ("Basic op", None),
        ("op", None),
        ("Bearer ö", None),
    ],
)
def test_a_bearer_token_proves_its_role(authenticator, header, role):
    assert authenticator.role_of_headers({"authorization": header}) is role


def test_no_headers_prove_nothing(authenticator):
    assert authenticator.role_of_headers({}) is None


def cookie(authenticator, value):
    return {"cookie": f"other=1; {authenticator.cookie_name}={value}"}


def test_a_session_lasts_its_time(authenticator, clock):
    headers = cookie(authenticator, authenticator.open_session(Role.VIEWER))
    assert authenticator.role_of_headers(headers) is Role.VIEWER

    clock.advance(SESSION_LIFETIME)
    assert authenticator.role_of_headers(headers) is None


def test_a_closed_session_is_worthless(authenticator):
    session = authenticator.open_session(Role.OPERATOR)
    authenticator.close_session(session)

    assert authenticator.role_of_headers(cookie(authenticator, session)) is None


def test_a_wrong_token_is_not_made_good_by_a_cookie(authenticator):
    headers = cookie(authenticator, authenticator.open_session(Role.OPERATOR))
    headers["authorization"] = "Bearer wrong"

    assert authenticator.role_of_headers(headers) is None


@pytest.mark.parametrize("text", ["a=b; =;;", "\x00", 'x="', ""])
def test_a_malformed_cookie_proves_nothing(authenticator, text):
    assert authenticator.role_of_headers({"cookie": text}) is None


def test_a_ticket_is_good_once(authenticator):
    ticket = authenticator.issue_ticket(Role.VIEWER)

    assert authenticator.redeem_ticket(ticket) is Role.VIEWER
    assert authenticator.redeem_ticket(ticket) is None


def test_an_old_ticket_is_worthless(authenticator, clock):
    ticket = authenticator.issue_ticket(Role.VIEWER)
    clock.advance(TICKET_LIFETIME)

    assert authenticator.redeem_ticket(ticket) is None


def test_tickets_do_not_pile_up(authenticator):
    tickets = [authenticator.issue_ticket(Role.VIEWER) for _ in range(MAX_GRANTS + 5)]

    assert authenticator.redeem_ticket(tickets[0]) is None
    assert authenticator.redeem_ticket(tickets[-1]) is Role.VIEWER
