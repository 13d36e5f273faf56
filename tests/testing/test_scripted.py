"""Scripted controllers note their calls and do what the test says."""

import pytest

from station.core import StationError
from station.testing.scripted import ScriptedBench


def test_every_callback_is_noted_and_may_do_something():
    bench = ScriptedBench()
    controller = bench.load("a", "j1")
    controller.actions["update"] = lambda: controller.command(2.0)

    bench.switch(["a"])
    bench.step()
    bench.switch([], ["a"])

    assert controller.calls == ["starting", "update", "update", "stopping"]
    assert bench.commands().count(2.0) == 0


def test_a_callback_that_raises_stops_its_controller():
    bench = ScriptedBench()
    controller = bench.load("a", "j1", kind="Velocity")
    bench.switch(["a"])
    controller.actions["update"] = lambda: 1 / 0

    bench.step()

    assert bench.state("a") == "aborted"
    assert "ZeroDivisionError" in bench.fault("a")


def test_init_can_be_told_to_raise():
    with pytest.raises(StationError, match="no bus"):
        ScriptedBench().load("a", "j1", init_raises="no bus")
