"""The sliders of gains, used as a person does."""

import pytest


@pytest.fixture
def panel(bench):
    bench.station.load("arm", running=True)
    panel = bench.dashboard.gains
    # The sliders are made one after the other, in a thread of the dashboard.
    both = {"panda_joint1/p", "panda_joint1/d"}
    assert bench.wait(lambda: both <= set(panel.sliders))
    return panel


def test_gains_come_from_the_schema(panel):
    slider = panel.sliders["panda_joint1/p"].slider
    assert (slider.label, slider.value) == ("p [Nm/rad]", 600.0)
    assert slider.min == 0.0
    assert set(panel.sliders) == {"panda_joint1/p", "panda_joint1/d"}


def test_a_moved_slider_changes_the_gain(bench, panel):
    bench.enter(panel.sliders["panda_joint1/p"].slider, 250.0)
    gains = bench.station.controllers["arm"].gains
    assert bench.wait(lambda: gains["panda_joint1/p"] == 250.0)


def test_sliders_follow_gains_set_by_others(bench, panel):
    bench.station.controllers["arm"].gains["panda_joint1/p"] = 4000.0
    slider = panel.sliders["panda_joint1/p"].slider
    assert bench.wait(lambda: slider.value == 4000.0)
    assert slider.max >= 4000.0


def test_another_joint_shows_its_own_gains(bench, panel):
    bench.enter(panel.group, "panda_joint3")
    assert bench.wait(lambda: "panda_joint3/p" in panel.sliders)
    bench.enter(panel.group, "panda_joint1")
    assert bench.wait(lambda: "panda_joint1/p" in panel.sliders)


def test_a_controller_without_gains_shows_a_hint(bench, panel):
    bench.station.controllers["arm"].gains.clear()
    assert bench.wait(lambda: "no gains to tune" in panel.note.content)
