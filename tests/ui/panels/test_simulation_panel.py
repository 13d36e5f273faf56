"""The Simulation tab, used as a person does."""

import pytest

from station.ui.panels.simulation_panel import SimulationPanel


@pytest.fixture
def panel(bench):
    panel = bench.panel(SimulationPanel)
    assert bench.wait(lambda: not panel._pause.disabled)
    return panel


def test_one_button_pauses_and_resumes_simulated_time(bench, panel):
    assert bench.wait(lambda: "Running at 1 of real time" in panel._state.content)

    bench.click(panel._pause)
    assert bench.wait(lambda: bench.station.simulation["paused"])
    assert bench.wait(lambda: panel._pause.label == "Resume")
    assert bench.wait(lambda: "Paused at 2.500 s" in panel._state.content)

    bench.click(panel._pause)
    assert bench.wait(lambda: not bench.station.simulation["paused"])


def test_steps_can_be_taken_while_paused_only(bench, panel):
    assert bench.wait(lambda: panel._step.disabled and panel._steps.disabled)
    bench.click(panel._pause)
    assert bench.wait(lambda: not panel._steps.disabled)

    bench.click(panel._steps)

    assert bench.wait(lambda: bench.station.simulation["time"] == 2.6)


def test_the_pace_is_chosen(bench, panel):
    bench.enter(panel._pace, "1/4")

    assert bench.wait(lambda: bench.station.simulation["real_time_factor"] == 0.25)


def test_the_world_is_reset(bench, panel):
    bench.click(panel._reset)

    assert bench.wait(lambda: bench.station.simulation["time"] == 0.0)


def test_a_real_robot_greys_everything_and_says_why(bench, panel):
    bench.station.simulation = None

    assert bench.wait(lambda: panel._pause.disabled and panel._reset.disabled)
    assert "franka_hw/FrankaHW is not simulated" in panel._state.content
