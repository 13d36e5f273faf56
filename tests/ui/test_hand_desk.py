"""What a person asks of the end effector, with an injected clock."""

import pytest

from station.ui.cartesian_model import HELD_FOR, POSE, TWIST
from station.ui.hand_desk import HandDesk
from tests.ui.views import controller, element, sample, view

HERE = sample(1.0, desired=0.5, names=POSE)


def _view(names, **changes):
    elements = {"hand": tuple(element(name, "m") for name in names)}
    running = controller("hand", "running", ("panda_robot",))
    parts = {"elements": elements, "samples": {"hand": HERE}, **changes}
    return view(running, **parts)


@pytest.fixture
def desk():
    return HandDesk()


def test_a_held_direction_moves_and_ends_with_one_rest(desk):
    desk.refresh(_view(TWIST))
    assert desk.hold(2, -1, now=0.0) == ""
    assert desk.step(0.1).values == pytest.approx([0, 0, -desk.speed, 0, 0, 0])
    desk.release()
    assert desk.step(0.2).values == [0.0] * 6
    assert desk.step(0.3) is None


def test_a_silent_browser_counts_as_released(desk):
    desk.refresh(_view(TWIST))
    desk.hold(0, 1, now=0.0)
    desk.step(0.1)
    assert desk.step(HELD_FOR + 0.1).values == [0.0] * 6


def test_a_typed_position_keeps_the_orientation(desk):
    desk.refresh(_view(POSE))
    assert desk.go([0.4, 0.1, 0.6], now=0.0) == ""
    assert desk.step(0.1).values == [0.4, 0.1, 0.6, 0.5, 0.5, 0.5, 0.5]


def test_without_a_controller_it_says_what_to_start(desk):
    desk.refresh(view())
    assert desk.hold(0, 1, now=0.0) != ""
    assert desk.go([0.4, 0.1, 0.6], now=0.0) != ""
    assert desk.step(0.1) is None


def test_a_stop_ends_the_motion(desk):
    desk.refresh(_view(POSE))
    desk.go([0.4, 0.1, 0.6], now=0.0)
    desk.refresh(_view(POSE, stop_state="stopped"))
    assert desk.step(0.1) is None
