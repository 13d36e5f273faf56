"""The sliders of joints, used as a person does."""

import pytest

from tests.ui.fake_station import START


@pytest.fixture
def panel(bench):
    bench.station.positions = list(START)
    bench.station.desired = list(START)
    return bench.dashboard.sliders


@pytest.fixture
def running(bench, panel):
    """A group controller runs, and the sliders follow it."""
    bench.station.load("arm", running=True)
    assert bench.wait(lambda: _value(bench, panel) is not None)
    assert bench.wait(lambda: not panel.sliders["panda_joint1"].slider.disabled)
    return bench


def _value(bench, panel):
    """Return the value that the slider of the first joint of a controller shows."""
    joints = panel.teleoperation.joints
    return joints.shown("panda_joint1", bench.link.now()) if joints.elements else None


def _commands(bench):
    return [r[2]["command"] for r in bench.station.requests if r[0] == "PUT"]


def test_sliders_are_greyed_with_the_reason(bench, panel):
    assert bench.wait(lambda: "No controller runs" in panel.state.content)
    assert all(slider.slider.disabled for slider in panel.sliders.values())


def test_greyed_sliders_show_the_robot(bench, panel):
    assert bench.wait(lambda: panel.sliders)
    bench.station.positions = [0.4, *START[1:]]
    assert bench.wait(lambda: panel.sliders["panda_joint1"].slider.value == 0.4)


def test_greyed_sliders_have_the_limits_that_the_robot_keeps(bench, panel):
    assert bench.wait(
        lambda: panel.sliders and panel.sliders["panda_joint1"].slider.max == 2.5
    )
    assert panel.sliders["panda_joint1"].slider.min == -2.5


def test_a_touched_slider_moves_its_joint_in_small_steps(running, panel):
    running.enter(panel.sliders["panda_joint1"].slider, 0.1)
    assert running.wait(lambda: running.station.positions[0] == pytest.approx(0.1))
    first = [command[0] for command in _commands(running)]
    steps = [b - a for a, b in zip([0.0, *first], first, strict=False)]
    assert max(steps) <= panel.speed.value * 0.04 + 1e-9
    assert all(set(command[1:]) == {None} for command in _commands(running))


def test_a_move_ends_when_somebody_else_moves_its_joint(running, panel):
    running.enter(panel.sliders["panda_joint1"].slider, 2.0)
    # The second command is sent when the first one was confirmed.
    assert running.wait(lambda: len(_commands(running)) > 1)
    reporter = running.dashboard.reporter

    def is_lost():
        # Of two commands the later one decides: a set-point that is on its way takes
        # the joint back when it is confirmed, so somebody else commands again, too.
        running.dashboard.movers.take("panda_joint1", "somebody else")
        return "Somebody else moves" in reporter.message

    assert running.wait(is_lost)
    assert not panel.teleoperation.joints.remaining


def test_sliders_follow_what_others_command(running, panel):
    running.station.desired = [0.7, *START[1:]]
    assert running.wait(lambda: panel.sliders["panda_joint1"].slider.value == 0.7)
    assert _commands(running) == []


def test_a_greyed_slider_sends_nothing(bench, panel):
    assert bench.wait(
        lambda: panel.sliders and panel.sliders["panda_joint1"].slider.disabled
    )
    bench.enter(panel.sliders["panda_joint1"].slider, 1.0)
    reporter = bench.dashboard.reporter
    assert bench.wait(lambda: "Not sent" in reporter.message)
    assert _commands(bench) == []


def test_a_stop_ends_a_move(running, panel):
    running.enter(panel.sliders["panda_joint1"].slider, 2.0)
    assert running.wait(lambda: _commands(running))
    running.station.stop()
    assert running.wait(lambda: not panel.teleoperation.joints.remaining)
    assert running.station.positions[0] < 1.9
