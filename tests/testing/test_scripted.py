"""Scripted controllers note their calls and do what the test says."""

import pytest

from station.core import StationError, SwitchRefusedError, SwitchState
from station.testing.bench import Bench
from station.testing.scripted import HookError, HookScript, ScriptedBench


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


@pytest.fixture
def script():
    return HookScript()


@pytest.fixture
def robot(script):
    robot = Bench().robot
    script.install(robot)
    return robot


def test_without_orders_the_robot_answers_itself(robot):
    robot.prepare_switch([], [])
    robot.do_switch([], [])

    assert robot.switches == [((), ())]
    assert robot.switch_result() is SwitchState.DONE


def test_prepare_switch_refuses_or_raises(robot, script):
    script.begin("no")
    with pytest.raises(SwitchRefusedError):
        robot.prepare_switch([], [])
    script.begin("raise")
    with pytest.raises(HookError):
        robot.prepare_switch([], [])


def test_do_switch_fails_before_the_robot_has_changed_anything(robot, script):
    script.begin(works=[False, True])

    with pytest.raises(HookError):
        robot.do_switch([], [])
    assert robot.switches == []
    robot.do_switch([], [])
    assert robot.switches == [((), ())]


def test_results_come_cycle_by_cycle_and_the_last_is_repeated(robot, script):
    script.begin(answers=["ONGOING", "ERROR", "DONE"])

    answers = [robot.switch_result() for _ in range(8)]

    assert [one.name for one in answers] == [
        *["ONGOING"] * 2,
        *["ERROR"] * 2,
        *["DONE"] * 4,
    ]
    script.begin(answers=["raise"])
    with pytest.raises(HookError):
        robot.switch_result()
