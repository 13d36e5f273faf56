"""Tokens, cookies and tickets."""

import pytest

from station.api.auth import (
    MAX_GRANTS,
    SESSION_LIFETIME,
    TICKET_LIFETIME,
    Access,
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


def role_of(authenticator, headers):
    access = authenticator.access_of_headers(headers)
    return None if access is None else access.role


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
    assert role_of(authenticator, {"authorization": header}) is role


def test_no_headers_prove_nothing(authenticator):
    assert role_of(authenticator, {}) is None


def cookie(authenticator, value):
    return {"cookie": f"other=1; {authenticator.cookie_name}={value}"}


def test_a_session_lasts_its_time(authenticator, clock):
    headers = cookie(authenticator, authenticator.open_session(Role.VIEWER))
    assert role_of(authenticator, headers) is Role.VIEWER

    clock.advance(SESSION_LIFETIME)
    assert role_of(authenticator, headers) is None


def test_a_closed_session_is_worthless(authenticator):
    session = authenticator.open_session(Role.OPERATOR)
    authenticator.close_session(session)

    assert role_of(authenticator, cookie(authenticator, session)) is None


def test_a_wrong_token_is_not_made_good_by_a_cookie(authenticator):
    headers = cookie(authenticator, authenticator.open_session(Role.OPERATOR))
    headers["authorization"] = "Bearer wrong"

    assert role_of(authenticator, headers) is None


@pytest.mark.parametrize("text", ["a=b; =;;", "\x00", 'x="', ""])
def test_a_malformed_cookie_proves_nothing(authenticator, text):
    assert role_of(authenticator, {"cookie": text}) is None


def test_a_ticket_is_good_once(authenticator):
    ticket = authenticator.issue_ticket(Access(Role.VIEWER))

    assert authenticator.redeem_ticket(ticket) == Access(Role.VIEWER)
    assert authenticator.redeem_ticket(ticket) is None


def test_an_old_ticket_is_worthless(authenticator, clock):
    ticket = authenticator.issue_ticket(Access(Role.VIEWER))
    clock.advance(TICKET_LIFETIME)

    assert authenticator.redeem_ticket(ticket) is None


def test_tickets_do_not_pile_up(authenticator):
    tickets = [
        authenticator.issue_ticket(Access(Role.VIEWER)) for _ in range(MAX_GRANTS + 5)
    ]

    assert authenticator.redeem_ticket(tickets[0]) is None
    assert authenticator.redeem_ticket(tickets[-1]) == Access(Role.VIEWER)


def test_viewers_do_not_displace_an_operators_session_or_ticket(authenticator):
    session = authenticator.open_session(Role.OPERATOR)
    ticket = authenticator.issue_ticket(Access(Role.OPERATOR))
    for _ in range(2 * MAX_GRANTS):
        authenticator.open_session(Role.VIEWER)
        authenticator.issue_ticket(Access(Role.VIEWER))

    assert role_of(authenticator, cookie(authenticator, session)) is Role.OPERATOR
    assert authenticator.redeem_ticket(ticket) == Access(Role.OPERATOR)


def test_the_oldest_session_of_a_role_makes_room_and_ends(authenticator):
    headers = cookie(authenticator, authenticator.open_session(Role.VIEWER))
    oldest = authenticator.access_of_headers(headers)
    for _ in range(MAX_GRANTS):
        authenticator.open_session(Role.VIEWER)

    assert oldest.has_ended()
    assert authenticator.access_of_headers(headers) is None


def test_a_ticket_ends_with_the_session_that_asked_for_it(authenticator):
    session = authenticator.open_session(Role.OPERATOR)
    access = authenticator.access_of_headers(cookie(authenticator, session))
    ticket = authenticator.issue_ticket(access)

    authenticator.close_session(session)

    assert authenticator.redeem_ticket(ticket) is None
