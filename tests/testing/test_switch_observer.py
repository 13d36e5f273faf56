"""The observer finds each kind of thing that must not happen, and nothing else."""

import math
from dataclasses import replace

import pytest

from station.core import CombinedRobotHW, RobotHW
from station.core.control.switching import SwitchOutcome
from station.testing.scripted import ScriptedBench
from station.testing.switch_observer import SwitchObserver, command_places


@pytest.fixture
def bench():
    bench = ScriptedBench()
    bench.load("a", "j1", kind="Velocity")
    bench.load("b", "j2", kind="Velocity")
    return bench


@pytest.fixture
def observer(bench):
    return SwitchObserver(bench.robot, bench.manager, drift=1e-9, settling=2)


def test_an_orderly_run_has_no_problems(bench, observer):
    bench.step(3)
    result = bench.switch(["a", "b"])
    bench.step(3)
    bench.switch([], ["a"])
    bench.step(10)

    assert observer.problems == []
    assert observer.untruth(result) is None
    assert observer.cycle == bench.manager.cycle


@pytest.mark.parametrize("command", [math.nan, math.inf, 0j, 1, None, "1.0"])
def test_a_command_that_is_no_finite_float_is_found(bench, observer, command):
    bench.robot.joints.velocity_command[2] = command

    observer.find_wrong_commands()

    assert "j3 is no finite float" in observer.problems[0]


@pytest.mark.usefixtures("open_gate")
def test_a_command_without_an_owner_that_moves_is_found(bench, observer):
    bench.step()
    bench.robot.joints.velocity_command[0] = 0.5

    bench.step()

    assert "without an owner changed from 0.0 to 0.5" in observer.problems[0]


@pytest.mark.usefixtures("open_gate")
def test_a_command_that_does_not_rest_when_its_owner_stops_is_found(bench, observer):
    a = bench.manager.get_controller("a")
    bench.switch(["a"])
    a.actions["update"] = lambda: a.command(0.04)
    bench.step()
    bench.switch([], ["a"])

    assert "does not rest at 0.0" in observer.problems[0]


@pytest.mark.usefixtures("open_gate")
def test_a_command_that_rests_where_it_did_before_its_owner_is_found():
    bench = ScriptedBench()
    bench.load("p", "j1", kind="Position")
    observer = SwitchObserver(bench.robot, bench.manager)
    bench.step()
    bench.switch(["p"])
    p = bench.manager.get_controller("p")
    p.command(0.01)
    bench.step(3)
    p.actions["stopping"] = lambda: p.command(0.0)
    bench.switch([], ["p"])

    assert "does not rest at 0.01" in observer.problems[0]


def test_a_joint_without_an_owner_that_moves_is_found(bench, observer):
    bench.step(5)
    bench.robot.joints.position[1] += 0.1

    bench.step()

    assert "joint j2 without an owner moved from 0.0 to 0.1" in observer.problems[0]


def test_a_second_owner_is_found(bench, observer):
    bench.load("also_a", "j1", kind="Velocity")
    bench.robot.check_for_conflict = lambda *_: []
    bench.switch(["a", "also_a"])

    assert "j1 is owned by a and also_a" in observer.problems[0]


def test_a_robot_that_was_not_told_is_found():
    bench = ScriptedBench()
    combined = CombinedRobotHW(lambda _: RobotHW())
    combined.add_robot("mock", bench.robot)
    bench.load("a", "j1", kind="Velocity")
    observer = SwitchObserver(combined, bench.manager)
    bench.switch(["a"])
    assert observer.problems == []
    bench.manager.get_controller("a").stop_request(0.0)

    observer.look()

    assert any("was not told what became of a" in one for one in observer.problems)


def test_an_untrue_answer_is_found(bench, observer):
    bench.step()
    result = bench.switch(["a"])
    halted = replace(result, ok=False, started=())
    stopped = replace(result, started=(), stopped=("a",))
    other = replace(result, started=("a", "b"))
    back = replace(
        result,
        plan=replace(result.plan, start=(), stop=result.plan.start),
        outcome=SwitchOutcome.ROLLED_BACK,
        cycle=result.cycle - 1,
        ok=False,
        failed={"b": "no bus"},
        started=(),
    )
    gone = replace(back, failed={"a": "it failed before"})

    assert observer.untruth(result) is None
    assert "without a reason" in str(observer.untruth(halted))
    assert "said to be stopped: a" in str(observer.untruth(stopped))
    assert "said to be started: a, b" in str(observer.untruth(other))
    assert "rolled back to a" in str(observer.untruth(back))
    assert observer.untruth(gone) is None
    assert "as planned" in str(observer.untruth(replace(result, cycle=0, started=())))


def test_after_a_reset_commands_may_rest_elsewhere(bench, observer):
    bench.step(5)
    bench.robot.joints.place([0.5, 0.5, 0.5])
    bench.robot.read(bench.time, 0.0)
    bench.manager.update(bench.time, 0.0, reset_controllers=True)
    observer.forget_rest()

    bench.step(5)

    assert observer.problems == []


def test_all_commands_of_all_interfaces_are_found(bench):
    places = command_places(bench.robot)

    # Position, velocity, effort; position and velocity; and both with acceleration.
    assert len(places) == 3 * (1 + 1 + 1 + 2 + 3)
    assert len({place.slot for place in places}) == 3 * 4
