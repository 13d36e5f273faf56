"""The dashboard as a whole, on its bench."""

import logging


def test_the_bar_is_live(bench):
    assert bench.wait(lambda: bench.dashboard.bar().link == "live")
    assert bench.dashboard.bar().mode == "idle"


def test_the_robot_on_screen_follows_the_station(bench):
    bench.station.positions = [0.33, *bench.station.positions[1:]]
    shown = bench.dashboard.scene._moving.shown
    assert bench.wait(lambda: abs(shown.get("panda_joint1", 0.0) - 0.33) < 1e-9)


def test_a_failing_panel_is_logged_and_shown_and_the_others_live(
    bench, monkeypatch, caplog
):
    panel = bench.dashboard.sliders

    def fail(_view):
        raise RuntimeError("broken panel")

    with caplog.at_level(logging.ERROR), monkeypatch.context() as patch:
        patch.setattr(bench.dashboard, "_failures", 0)
        patch.setattr(panel, "refresh", fail)
        assert bench.wait(lambda: "broken panel" in bench.dashboard.bar().message)
    assert "broken panel" in caplog.text
    assert bench.wait(lambda: bench.dashboard.bar().link == "live")
