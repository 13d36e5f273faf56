"""The hold-to-run buttons of the Operate tab, used as a person does."""

import pytest

from station.ui.panels.jog_panel import HEARTBEAT_HZ, JogPanel

JOG = "franka_controllers/CartesianJogController"


@pytest.fixture
def panel(bench):
    return bench.panel(JogPanel)


@pytest.fixture
def running(bench, panel):
    """A jog controller runs."""
    bench.station.load("jog", JOG, running=True)
    assert bench.wait(lambda: panel.watched() == {"jog"})
    assert bench.wait(lambda: not panel._handles[0].disabled)
    bench.station.requests.clear()
    return bench


def hold(bench, panel, index):
    """Say once that a button is held, as its browser does."""
    uuid = panel._handles[index]._impl.uuid
    message = {"type": "GuiButtonHoldMessage", "uuid": uuid, "frequency": HEARTBEAT_HZ}
    bench._send(message)


def twists(bench):
    return [r[2]["command"] for r in bench.station.requests if r[0] == "PUT"]


def test_disabled_buttons_name_the_controller_to_start(bench, panel):
    assert bench.wait(lambda: "Load a CartesianJog" in panel._state.content)
    bench.station.load("jog", JOG)
    assert bench.wait(lambda: "Start jog in the Contr" in panel._state.content)
    assert all(button.disabled for button in panel._handles)


def test_a_held_button_moves_at_the_speed_set_and_then_stops(running, panel):
    hold(running, panel, 3)  # minus y
    assert running.wait(
        lambda: len(twists(running)) > 1 and not any(twists(running)[-1])
    )
    speed = panel._speed.value

    assert twists(running)[0] == pytest.approx([0.0, -speed, 0.0, 0.0, 0.0, 0.0])
    assert sum(not any(twist) for twist in twists(running)) == 1


def test_a_greyed_button_sends_nothing(bench, panel):
    assert bench.wait(lambda: panel._handles[0].disabled)
    hold(bench, panel, 0)
    assert bench.wait(lambda: "Not sent" in bench.dashboard._reporter.message)
    assert twists(bench) == []


def test_a_stop_lets_go(running, panel):
    hold(running, panel, 0)
    running.station._stop()
    assert running.wait(lambda: all(button.disabled for button in panel._handles))
    running.station.requests.clear()

    assert panel._buttons.twist(running.link.now(), 0.1, 0.1) is None


def test_the_dropdown_shows_and_changes_the_axes_of_the_jog_controller(bench, panel):
    bench.station.load("jog", JOG, running=True)
    bench.station.controllers["jog"].gains = {"frame": 1.0}
    assert bench.wait(lambda: panel._axes.value == "End effector")
    assert bench.wait(lambda: not panel._axes.disabled)
    bench.enter(panel._axes, "Base")

    gains = bench.station.controllers["jog"].gains
    assert bench.wait(lambda: gains == {"frame": 0.0})
