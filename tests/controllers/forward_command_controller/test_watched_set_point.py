"""The newest set-point counts until it is too old or void; then rest does."""

import pytest

from station.controllers.forward_command_controller.command_timeout import TimeoutAction
from station.controllers.forward_command_controller.watched_set_point import (
    WatchedSetPoint,
)
from station.core.clock import ManualClock
from station.core.errors import CommandTimeoutError
from station.core.ports.set_point import SetPointElement, SetPointPort


@pytest.fixture
def port():
    return SetPointPort(
        [SetPointElement("a", "rad", -1.0, 1.0)], timeout=0.2, clock=ManualClock()
    )


def watch(port, action=TimeoutAction.HOLD):
    watched = WatchedSetPoint(port, action, "the arm", lambda: [0.5])
    watched.begin()
    return watched


def test_the_first_set_point_in_force_is_rest(port):
    assert watch(port).newest() == [0.5]


def test_the_newest_is_kept_within_its_range_and_brings_its_rates(port):
    watched = watch(port)
    port.post([3.0, 0.1])

    assert watched.newest() == [1.0]
    assert watched.rates == [0.1]
    assert watched.newest() is watched.values


def test_rest_replaces_a_void_or_expired_set_point(port):
    watched = watch(port)
    port.post([0.1])
    watched.newest()
    port.clock.advance(0.21)
    assert watched.newest() == [0.5]
    assert port.last == [0.5]

    port.post([0.1])
    watched.newest()
    port.clear()
    assert watched.newest() == [0.5]


def test_stop_fails_and_says_what_got_no_set_points(port):
    watched = watch(port, TimeoutAction.STOP)
    port.post([0.1])
    watched.newest()
    port.clock.advance(0.21)

    with pytest.raises(CommandTimeoutError, match="for the arm arrived in time"):
        watched.newest()
