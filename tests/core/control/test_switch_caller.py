"""One switch at a time asks the robot, and a robot that hangs holds up nobody else."""

import threading

import pytest

from station.core.errors import SwitchRefusedError, SwitchTimeoutError
from station.testing.scripted import ScriptedBench
from tests.waiting import PATIENCE


@pytest.fixture
def bench():
    return ScriptedBench()


def names(bench):
    return {one.name: one.state.value for one in bench.manager.list_controllers()}


def test_a_robot_that_prepares_for_ever_holds_up_switches_alone(bench):
    reached, go_on = threading.Event(), threading.Event()

    def prepare(*_):
        reached.set()
        go_on.wait(PATIENCE)

    bench.load("arm", "j1")
    bench.load("other", "j2")
    bench.robot.prepare_switch = prepare
    thread = threading.Thread(target=bench.switch, args=(["arm"],))
    thread.start()
    assert reached.wait(PATIENCE)

    with pytest.raises(SwitchTimeoutError, match="prepare_switch"):
        bench.switch(["other"], bound=0.01)
    bench.load("third", "j3")
    assert set(names(bench)) == {"arm", "other", "third"}

    go_on.set()
    thread.join(PATIENCE)
    assert names(bench)["arm"] == "running"


@pytest.mark.parametrize("hook", ["prepare_switch", "check_for_conflict"])
def test_whatever_a_hook_of_the_robot_raises_is_a_refusal(bench, hook):
    bench.load("arm", "j1")
    setattr(bench.robot, hook, lambda *_: 1 / 0)

    with pytest.raises(
        SwitchRefusedError, match=f"{hook} raised ZeroDivision"
    ) as refusal:
        bench.switch(["arm"])

    assert "ZeroDivisionError" in refusal.value.details["traceback"]
    assert names(bench) == {"arm": "initialized"}


def test_a_robot_that_switches_while_it_is_asked_is_refused(bench):
    bench.load("arm", "j1")
    bench.robot.prepare_switch = lambda *_: bench.switch(["arm"])

    with pytest.raises(Exception, match="wait for itself"):
        bench.switch(["arm"])


def test_without_a_bound_a_switch_takes_as_long_as_the_hardware(bench):
    bench.load("arm", "j1")
    bench.robot.script.switch_cycles = 1000  # 10 s, twice the usual bound

    assert not bench.switch(["arm"]).ok
    bench.robot.script.switch_cycles = 1000

    assert bench.switch(["arm"], bound=None).ok


def test_a_stop_that_the_robot_was_not_told_of_can_be_repeated(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    do_switch = bench.robot.do_switch
    bench.robot.do_switch = lambda *_: 1 / 0
    assert not bench.switch(stop=["arm"]).ok
    with pytest.raises(Exception, match="may still be in its mode"):
        bench.manager.unload_controller("arm")
    bench.robot.do_switch = do_switch

    assert bench.switch(stop=["arm"]).ok

    assert bench.robot.joints.mode == ["", "", ""]
    bench.manager.unload_controller("arm")
