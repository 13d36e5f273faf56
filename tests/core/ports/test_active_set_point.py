"""The newest set-point counts until it is too old or void; then rest does."""

import pytest

from station.core.clock import ManualClock
from station.core.errors import CommandTimeoutError
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointElement,
    SetPointPort,
    TimeoutAction,
)


@pytest.fixture
def port():
    return SetPointPort(
        [SetPointElement("a", "rad", -1.0, 1.0)], timeout=0.2, clock=ManualClock()
    )


def start(port, action=TimeoutAction.HOLD):
    active = ActiveSetPoint(port, action, "the arm", lambda: [0.5])
    active.start_at_rest()
    return active


def test_the_first_set_point_in_force_is_rest(port):
    assert start(port).newest() == [0.5]


def test_the_newest_is_kept_within_its_range_and_brings_its_rates(port):
    active = start(port)
    port.post([3.0, 0.1])

    assert active.newest() == [1.0]
    assert [*active.desired_rates] == [0.1]
    assert active.newest() is active.values


def test_rest_replaces_a_void_or_expired_set_point(port):
    active = start(port)
    port.post([0.1])
    active.newest()
    port.clock.advance(0.21)
    assert active.newest() == [0.5]
    assert port.last == [0.5]

    port.post([0.1])
    active.newest()
    port.clear()
    assert active.newest() == [0.5]


def test_stop_fails_and_says_what_got_no_set_points(port):
    active = start(port, TimeoutAction.STOP)
    port.post([0.1])
    active.newest()
    port.clock.advance(0.21)

    with pytest.raises(CommandTimeoutError, match="for the arm arrived in time"):
        active.newest()
