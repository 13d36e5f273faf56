"""The one-slot mailbox of set-points and its time limit."""

import pytest

from station.core.clock import ManualClock
from station.core.errors import InvalidCommandError
from station.core.ports.set_point import SetPointElement, SetPointPort

ELEMENTS = [SetPointElement("a", "rad", -1.0, 1.0), SetPointElement("b", "rad")]


@pytest.fixture
def clock():
    return ManualClock()


@pytest.fixture
def port(clock):
    return SetPointPort(ELEMENTS, timeout=0.5, clock=clock)


def test_the_newest_set_point_is_taken_once(port):
    port.post([0.1, 0.1])
    port.post([0.2, 0.2])
    assert port.take() == [0.2, 0.2]
    assert port.take() is None
    assert port.last == [0.2, 0.2]


def test_a_posted_list_may_be_changed_afterwards(port):
    values = [0.1, 0.1]
    port.post(values)
    values[0] = 9.0
    assert port.take() == [0.1, 0.1]


def test_the_set_point_in_force_is_the_one_posted_last_until_it_ends(port, clock):
    assert port.newest is None
    port.post([0.1, 0.1])
    port.take()
    port.post([0.2, 0.2])
    assert port.newest == [0.2, 0.2]
    port.take()
    clock.advance(0.6)
    port.take_expiry()
    assert port.newest is None
    port.post([0.3, 0.3])
    port.expire()
    assert port.newest is None
    port.post([0.3, 0.3])
    port.clear()
    assert port.newest is None
    port.post([0.4, 0.4], generation=0)  # decided before the stop
    assert port.newest is None


@pytest.mark.parametrize(
    ("values", "count"),
    [([0.0], "1 value"), ([0.0, 0.0, 0.0], "3 values"), ([], "0 values")],
)
def test_a_wrong_length_is_refused(port, values, count):
    with pytest.raises(InvalidCommandError, match=f"has {count}; .* takes 2: a, b"):
        port.check(values)


@pytest.mark.parametrize("value", [1.01, float("nan"), float("inf"), float("-inf")])
def test_a_value_that_is_not_allowed_is_refused(port, value):
    with pytest.raises(InvalidCommandError, match="for 'a' is"):
        port.check([value, 0.0])


def test_an_unlimited_element_still_has_to_be_finite(port):
    port.check([0.0, 1e300])
    with pytest.raises(InvalidCommandError, match="for 'b' is inf"):
        port.check([0.0, float("inf")])


def test_a_set_point_expires_once(port, clock):
    port.post([0.1, 0.1])
    port.take()
    clock.advance(0.5)
    assert not port.take_expiry()
    clock.advance(0.001)
    assert port.take_expiry()
    assert not port.take_expiry()


def test_another_port_follows_set_points_their_expiry_and_their_end(port, clock):
    # Its own clock and time limit do not count.
    other = SetPointPort(ELEMENTS, timeout=0.1, clock=ManualClock(100.0))
    port.post([0.1, 0.2])
    other.follow_changes(port.take_changes())
    assert (other.take_void(), other.take(), other.take_expiry()) == (
        False, [0.1, 0.2], False,
    )  # fmt: skip
    clock.advance(0.6)
    other.follow_changes(port.take_changes())
    assert (other.take(), other.take_expiry(), other.take_expiry()) == (
        None, True, False,
    )  # fmt: skip
    # One that came too late is picked up and expires at once.
    port.post([0.3, 0.3])
    clock.advance(0.6)
    other.follow_changes(port.take_changes())
    assert (other.take(), other.take_expiry()) == ([0.3, 0.3], True)
    port.clear()
    other.follow_changes(port.take_changes())
    assert other.take_void()
    assert other.last is None


def test_time_counts_from_the_arrival(port, clock):
    port.post([0.1, 0.1])
    clock.advance(0.6)
    port.take()
    assert port.take_expiry()


def test_a_newer_set_point_renews_the_time_limit(port, clock):
    port.post([0.1, 0.1])
    port.take()
    clock.advance(0.4)
    port.post([0.2, 0.2])
    port.take()
    clock.advance(0.4)
    assert not port.take_expiry()


def test_a_set_point_may_be_valid_for_ever(port, clock):
    port.post([0.1, 0.1], timeout=0.0)
    port.take()
    clock.advance(1e9)
    assert not port.take_expiry()


def test_clearing_voids_all_set_points_and_the_time_limit(port, clock):
    port.post([0.1, 0.1])
    port.take()
    port.post([0.2, 0.2])
    port.clear()
    clock.advance(1.0)
    assert port.last is None
    assert port.take() is None
    assert not port.take_expiry()


@pytest.mark.parametrize("timeout", [0.0, 1.5, float("inf"), float("nan")])
def test_a_port_can_bound_how_long_a_set_point_is_valid(timeout):
    port = SetPointPort([SetPointElement("j", "rad/s")], timeout=0.2, longest=1.0)
    port.check([0.1])
    port.check([0.1], 1.0)

    with pytest.raises(InvalidCommandError, match="timeout"):
        port.check([0.1], timeout)


def test_clearing_is_told_once():
    port = SetPointPort([SetPointElement("j", "rad")])
    assert not port.take_void()
    port.clear()
    assert port.take_void()
    assert not port.take_void()


@pytest.mark.parametrize("rates", [[], [0.1, 0.2], [1.1], [float("nan")]])
def test_rates_are_checked_like_the_values(rates):
    port = SetPointPort([SetPointElement("j", "rad")])
    port.feed_forward = [SetPointElement("j", "rad/s", -1.0, 1.0)]
    port.check([0.1], rates=[-1.0])
    port.check([0.1])

    with pytest.raises(InvalidCommandError):
        port.check([0.1], rates=rates)
    with pytest.raises(InvalidCommandError, match="2 values"):
        port.check([0.1, 0.2])


def test_there_is_a_change_when_a_set_point_waits_is_void_or_expired(port, clock):
    assert not port.has_changed()
    port.post([0.1, 0.1])
    assert port.has_changed()
    port.take()
    assert not port.has_changed()
    clock.advance(0.501)
    assert port.has_changed()
    assert port.take_expiry()
    assert not port.has_changed()
    port.clear()
    assert port.has_changed()
    assert port.take_void()
    assert not port.has_changed()


def test_a_set_point_in_force_expires_at_once_when_told(port):
    port.post([0.1, 0.1], timeout=0.0)
    port.take()
    port.expire()

    assert port.has_changed()
    assert port.take() is None
    assert port.take_expiry()
    assert not port.take_expiry()
    assert not port.has_changed()


def test_a_set_point_in_the_slot_never_is_picked_up_once_it_was_let_expire(port):
    port.post([0.1, 0.1])
    port.expire()

    assert port.take() is None
    assert not port.take_expiry()
    assert port.last is None


@pytest.mark.parametrize("value", ["0.5", [0.5], True, {"a": 1.0}])
def test_what_is_no_number_is_refused_by_name(port, value):
    with pytest.raises(InvalidCommandError, match="must be a number") as caught:
        port.check([value] * len(port.elements))
    assert f"'{port.elements[0].name}' is {value!r}" in str(caught.value)


def test_a_position_may_be_a_little_beyond_its_range():
    position = SetPointPort([SetPointElement("a", "rad", -1.0, 1.0)])
    position.check([1.00009])
    with pytest.raises(InvalidCommandError, match=r"-1\.0 to 1\.0 rad"):
        position.check([-1.0002])
    velocity = SetPointPort([SetPointElement("a", "rad/s", -1.0, 1.0)])
    with pytest.raises(InvalidCommandError, match=r"1\.00009"):
        velocity.check([1.00009])
