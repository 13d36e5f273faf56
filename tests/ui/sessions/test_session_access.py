"""Credentials of a session at the station: its role's token, and its lease."""

import pytest

from station.ui.link.station_access import StationAccess
from station.ui.sessions.session_access import SessionAccess
from station.ui.sessions.sessions import BrowserSession, Role
from station.wire import ControlState

FIRST = StationAccess("http://one", "operator 1", "", "viewer 1")
NEXT = StationAccess("http://two", "operator 2", "", "viewer 2")
ADA = BrowserSession("a", Role.OPERATOR)
BOB = BrowserSession("b", Role.OPERATOR)
GUEST = BrowserSession("g", Role.VIEWER)
MINE = ControlState(owner="ada", mine=True, lease="key", ttl=10.0, expires_in=10.0)


class _Clock:
    def __init__(self):
        self.time = 100.0

    def __call__(self):
        return self.time


@pytest.fixture
def clock():
    return _Clock()


@pytest.fixture
def leases():
    return []


@pytest.fixture
def access(clock, leases):
    return SessionAccess(FIRST, leases.append, clock)


@pytest.mark.parametrize(("session", "word"), [(ADA, "operator"), (GUEST, "viewer")])
def test_a_session_has_its_roles_token_at_every_station(access, session, word):
    assert access.token_of(session) == f"{word} 1"
    access.move_to(NEXT)
    assert access.token_of(session) == f"{word} 2"


def test_a_named_token_is_kept_and_a_token_of_the_start_is_not(access):
    assert access.own_token("operator 1") == ""
    assert access.own_token("viewer 1") == ""
    named = BrowserSession("n", Role.VIEWER, access.own_token("ada's"))
    access.move_to(NEXT)
    assert access.token_of(named) == "ada's"


def test_nobody_gets_a_token_of_a_station_that_has_ended(access, leases):
    named = BrowserSession("n", Role.OPERATOR, "ada's")
    access.note(ADA, MINE, None, 100.0)
    access.move_to(None)
    assert access.is_lost
    assert [access.token_of(s) for s in (ADA, GUEST, named)] == [None] * 3
    assert access.headers_of(ADA) == {}
    assert leases == ["key", None]
    access.move_to(NEXT)
    assert not access.is_lost
    assert access.token_of(named) == "ada's"


@pytest.mark.parametrize(
    ("follows", "session", "token", "is_withdrawn"),
    [
        (True, ADA, "operator 1", False),  # The station's next start tells others.
        (False, ADA, "operator 1", True),  # Nobody will tell.
        (True, BrowserSession("n", Role.OPERATOR, "ada's"), "ada's", True),
        (True, BrowserSession("n", Role.OPERATOR, "ada's"), None, False),
        (False, ADA, "operator 0", False),  # It has been replaced meanwhile.
    ],
)
def test_a_refused_token_ends_the_session_if_it_was_withdrawn(
    follows, session, token, is_withdrawn
):
    access = SessionAccess(FIRST, follows=follows)
    assert access.is_withdrawn(session, token) is is_withdrawn


def test_a_viewer_never_gets_another_roles_token(access):
    access.move_to(StationAccess("http://two", "operator 2", ""))
    assert "operator 2" not in access.headers_of(GUEST)["Authorization"]
    assert access.token_of(GUEST)  # An empty one would let the client look for another.


def test_the_lease_goes_with_the_requests_of_its_session_alone(access, leases):
    access.note(ADA, MINE, None, 100.0)
    assert access.headers_of(ADA)["X-Control-Lease"] == "key"
    assert "X-Control-Lease" not in access.headers_of(BOB)
    assert leases == ["key"]


def test_a_lease_without_heartbeats_is_not_used_any_more(access, clock):
    access.note(ADA, MINE, None, 100.0)
    clock.time = 109.9
    assert access.lease_of(ADA) == "key"
    clock.time = 110.0
    assert access.lease_of(ADA) is None


def test_who_does_not_hold_control_only_watches_visers_panel(access):
    assert access.role_at_viser(BOB) is Role.OPERATOR
    access.note(ADA, MINE, None, 100.0)
    assert access.role_at_viser(BOB) is Role.VIEWER
    assert access.role_at_viser(ADA) is Role.OPERATOR
    assert access.role_at_viser(GUEST) is Role.VIEWER


def test_control_that_another_session_takes_is_lost(access, leases):
    access.note(ADA, MINE, None, 100.0)
    taken = MINE.model_copy(update={"owner": "bob", "lease": "other"})
    access.note(BOB, taken, None, 101.0)
    assert (access.lease_of(ADA), access.lease_of(BOB)) == (None, "other")
    assert leases == ["key", "other"]


def test_an_answer_to_an_older_question_takes_nothing_away(access, leases):
    access.note(ADA, MINE, None, 100.0)
    access.note(ADA, ControlState(), None, 99.0)
    assert access.lease_of(ADA) == "key"
    access.note(ADA, ControlState(), "key", 101.0)
    assert access.lease_of(ADA) is None
    assert leases == ["key", None]


def test_another_station_has_given_nothing(access, leases):
    access.note(ADA, MINE, None, 100.0)
    access.move_to(NEXT)
    assert access.lease_of(ADA) is None
    assert leases == ["key", None]


def test_a_client_is_renewed_for_the_station_of_now(access):
    client = access.client_of(ADA)
    access.move_to(NEXT)
    access.note(ADA, MINE, None, 100.0)
    assert access.renew(client, ADA) == "key"
    assert client.url == "http://two"
