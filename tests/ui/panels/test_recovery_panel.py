"""The recovery button, used as a person does."""

import pytest

from station.ui.panels.recovery_panel import RecoveryPanel


@pytest.fixture
def panel(bench):
    return bench.panel(RecoveryPanel)


def test_button_is_there_only_when_something_is_wrong(bench, panel):
    assert bench.wait(lambda: not panel._button.visible)
    bench.station.arms = {"panda": "reflex"}
    assert bench.wait(lambda: panel._button.visible and panel._reason.visible)
    bench.station.arms = {"panda": "idle"}
    assert bench.wait(lambda: not panel._button.visible)
    assert panel._button.disabled


def test_arm_in_reflex_is_recovered_by_clicking(bench, panel):
    bench.station.arms = {"panda": "reflex"}
    assert bench.wait(lambda: not panel._button.disabled)
    assert panel._button.label == "Recover panda"
    assert "cartesian_reflex at z: -30 N" in panel._trouble.content
    bench.click(panel._button)
    assert bench.wait(lambda: bench.station.arms["panda"] == "idle")
    assert bench.wait(lambda: panel._button.disabled)
    assert bench.wait(lambda: not panel._trouble.visible)


def test_user_stop_is_released_by_clicking(bench, panel):
    bench.station.arms = {"panda": "user_stopped"}
    assert bench.wait(lambda: "Release the user stop" in panel._button.label)
    bench.click(panel._button)
    assert bench.wait(lambda: bench.station.arms["panda"] == "idle")


def test_click_that_comes_too_late_is_answered_and_not_sent(bench, panel):
    bench.station.arms = {"panda": "idle"}
    assert bench.wait(lambda: not panel._button.visible)
    bench.click(panel._button)
    reporter = bench.dashboard._reporter
    assert bench.wait(lambda: "Nothing to recover" in reporter.message)
    assert all(request[0] == "GET" for request in bench.station.requests)
