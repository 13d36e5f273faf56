"""The lease of control."""

import threading

import pytest

from station.api.auth import Access, LoginSession, Role
from station.api.control import Control, ControlHeldError, ControlNotHeldError
from station.api.named_tokens import NamedToken
from station.core.clock import ManualClock
from station.events import EventKind, EventLog, Origin
from tests.waiting import PATIENCE

SHARED = Access(Role.OPERATOR)
ADA = Access(Role.OPERATOR, token=NamedToken("ada", "operator", "1", 0.0))
GRACE = Access(Role.OPERATOR, token=NamedToken("grace", "operator", "2", 0.0))
ME = Origin("me", "127.0.0.1")


@pytest.fixture
def clock():
    return ManualClock()


@pytest.fixture
def log():
    return EventLog()


@pytest.fixture
def held():
    return []


@pytest.fixture
def control(log, held, clock):
    return Control(log, lambda names, reason: held.append((names, reason)), clock.now)


def command(control, controller):
    with control.commanding(ADA, None, controller):
        pass


def results(log):
    return [event.result for event in log.since(kinds=[EventKind.CONTROL])]


def test_without_a_lease_everybody_may(control):
    control.check(ADA, None)
    control.check(SHARED, None)

    assert control.present() is None


def test_who_holds_control_is_called_by_the_name_that_was_given(control):
    lease = control.take(SHARED, None, "Ada", 10.0, origin=ME)

    assert control.name_of(SHARED, lease.key) == "Ada (operator)"
    assert control.name_of(SHARED, None) == "operator"
    assert control.name_of(GRACE, None) == "grace"
    control.take(GRACE, None, "grace", 10.0, force=True, origin=ME)
    assert control.name_of(GRACE, None) == "grace"


def test_others_are_refused_with_the_owners_name(control):
    control.take(ADA, None, "Ada", 10.0, origin=ME)

    control.check(ADA, None)
    with pytest.raises(ControlHeldError, match="Ada holds control since"):
        control.check(GRACE, None)
    with pytest.raises(ControlHeldError):
        control.take(GRACE, None, "Grace", 10.0, origin=ME)


def test_who_shares_a_token_is_told_apart_by_the_lease(control):
    lease = control.take(SHARED, None, "one", 10.0, origin=ME)

    control.check(SHARED, lease.key)
    for key in (None, "", "wrong"):
        with pytest.raises(ControlHeldError):
            control.check(SHARED, key)


def test_a_browser_session_is_one_person(control, clock):
    one, other = (LoginSession(Role.OPERATOR, clock) for _ in range(2))
    control.take(Access(Role.OPERATOR, one), None, "tab", 10.0, origin=ME)

    control.check(Access(Role.OPERATOR, one), None)
    with pytest.raises(ControlHeldError):
        control.check(Access(Role.OPERATOR, other), None)


def test_it_expires_without_a_heartbeat_and_what_moved_is_held(
    control, clock, held, log
):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    command(control, "arm")
    clock.advance(9.0)
    control.renew(ADA, None, None, None, ME)
    clock.advance(9.0)
    assert control.present() is not None
    clock.advance(2.0)

    assert control.present() is None
    assert held == [({"arm"}, "Ada has lost control: no heartbeat came for 10 s.")]
    assert results(log) == ["taken", "expired"]
    with pytest.raises(ControlNotHeldError):
        control.renew(ADA, None, None, None, ME)


def test_it_is_taken_by_force_and_what_moved_is_held(control, held, log):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    command(control, "arm")
    told = []
    control.listen(lambda: told.append(control.present().owner))

    control.take(GRACE, None, "Grace", 10.0, force=True, origin=ME)

    assert [names for names, _ in held] == [{"arm"}]
    assert told == ["Grace"]
    assert results(log) == ["taken", "forced"]
    assert "Grace has taken control from Ada by force." in log.since()[-1].text
    assert held[0][1] == "Grace has taken control from Ada by force."
    with pytest.raises(ControlHeldError):
        control.renew(ADA, None, None, None, ME)


def test_it_is_handed_over_to_a_named_one_and_the_motion_goes_on(control, held, log):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    command(control, "arm")
    control.renew(ADA, None, None, "grace", ME)

    with pytest.raises(ControlHeldError):
        control.take(SHARED, None, "somebody", 10.0, origin=ME)
    control.take(GRACE, None, "Dr. Hopper", 10.0, origin=ME)

    assert control.present().owner == "Dr. Hopper"
    assert held == []
    assert results(log) == ["taken", "offered", "handed over"]


def test_what_was_handed_over_is_held_when_the_heir_loses_control(control, held):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    command(control, "arm")
    control.renew(ADA, None, None, "grace", ME)
    control.take(GRACE, None, "Grace", 10.0, origin=ME)

    control.take(ADA, None, "Ada", 10.0, force=True, origin=ME)

    assert [names for names, _ in held] == [{"arm"}]


def test_a_goal_is_admitted_before_it_is_planned_and_afterwards(control, held):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    control.admit(ADA, None, "arm")
    control.take(GRACE, None, "Grace", 10.0, force=True, origin=ME)

    with pytest.raises(ControlHeldError):
        control.admit(ADA, None, "arm")
    assert [names for names, _ in held] == [{"arm"}]


def test_an_heir_who_uses_force_takes_control_as_anybody_does(control, held, log):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    command(control, "arm")
    control.renew(ADA, None, None, "grace", ME)

    control.take(GRACE, None, "Grace", 10.0, force=True, origin=ME)

    assert [names for names, _ in held] == [{"arm"}]
    assert results(log) == ["taken", "offered", "forced"]


def test_a_set_point_that_comes_after_the_take_over_is_refused(control):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    control.take(GRACE, None, "Grace", 10.0, force=True, origin=ME)

    with pytest.raises(ControlHeldError):
        command(control, "arm")
    assert control.present().commanded == set()


def test_nobody_takes_control_while_a_set_point_is_given(control, held):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    taken = threading.Thread(
        target=lambda: control.take(GRACE, None, "G", 10.0, force=True, origin=ME)
    )
    with control.commanding(ADA, None, "arm"):
        taken.start()
        taken.join(0.05)  # as long as it takes to take control, many times over
        assert control.present().owner == "Ada"
    taken.join(PATIENCE)

    assert control.present().owner == "G"
    assert [names for names, _ in held] == [{"arm"}]


def test_it_is_given_back(control, held):
    control.take(ADA, None, "Ada", 10.0, origin=ME)
    with pytest.raises(ControlHeldError):
        control.release(GRACE, None, ME)
    control.release(ADA, None, ME)

    control.check(GRACE, None)
    assert held == []


def test_it_ends_with_the_owners_token(control):
    token = NamedToken("eve", "operator", "3", 0.0)
    control.take(Access(Role.OPERATOR, token=token), None, "Eve", 10.0, origin=ME)
    token.revoke()

    assert control.present() is None


def test_taking_it_again_is_a_heartbeat(control, clock, log):
    first = control.take(ADA, None, "Ada", 10.0, origin=ME)
    clock.advance(9.0)
    again = control.take(ADA, None, "Ada", 10.0, origin=ME)

    assert again.key == first.key
    assert again.deadline == first.deadline + 9.0
    assert results(log) == ["taken"]
