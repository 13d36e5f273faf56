"""What users of robots run into, section (c) 1 to 11: switching and the manager.

Each test is named after what must not go wrong again.
"""

import math
import threading

import pytest

from station.core.clock import SystemClock
from station.core.control.switching import Strictness
from station.core.errors import (
    ControllerExistsError,
    ControllerStateError,
    ResourceConflictError,
    SwitchRefusedError,
    SwitchTimeoutError,
)
from station.core.loop.control_loop import ControlLoop
from station.core.ports.set_point import SetPointElement, SetPointPort
from station.testing.scripted import ScriptedBench

BEST_EFFORT = Strictness.BEST_EFFORT


@pytest.fixture
def bench():
    return ScriptedBench()


@pytest.fixture
def threaded():
    """A bench on the system's clock."""
    return ScriptedBench(SystemClock())


@pytest.fixture
def loop(threaded):
    """The loop of `threaded`, running in its thread."""
    bench = threaded
    loop = ControlLoop(bench.robot, bench.manager, clock=SystemClock())
    loop.start()
    yield loop
    loop.stop()


def test_1_a_switch_on_a_frozen_loop_ends_and_the_manager_goes_on(bench):
    bench.load("arm", "j1")
    bench.manager.pump = None

    with pytest.raises(SwitchTimeoutError):
        bench.switch(["arm"], timeout=0.5)

    bench.manager.pump = bench.step
    assert bench.switch(["arm"]).ok


def test_2_a_switch_from_the_thread_that_owns_the_loop_does_not_deadlock(bench):
    bench.load("arm", "j1")
    loop = ControlLoop(bench.robot, bench.manager, clock=bench.clock)
    loop.step()

    assert bench.switch(["arm"]).ok


def test_2_a_switch_within_the_control_thread_does_not_deadlock(threaded, loop):
    bench = threaded
    bench.load("arm", "j1")
    loop.run_in_cycle(lambda: None)

    with pytest.raises(ControllerStateError, match="control thread"):
        loop.run_in_cycle(lambda: bench.switch(["arm"]))

    assert bench.switch(["arm"]).ok


@pytest.mark.parametrize("strictness", list(Strictness))
def test_3_start_and_stop_of_the_same_running_controller_is_said(bench, strictness):
    bench.load("arm", "j1")
    bench.switch(["arm"])

    with pytest.raises(SwitchRefusedError, match="'arm'"):
        bench.switch(["arm"], ["arm"], strictness)


@pytest.mark.parametrize(
    ("start", "stop"), [(["nope"], []), ([], ["nope"]), (["run"], []), ([], ["idle"])]
)
def test_3_strict_refuses_what_best_effort_leaves_out(bench, start, stop):
    bench.load("run", "j1")
    bench.load("idle", "j2")
    bench.switch(["run"])

    with pytest.raises(SwitchRefusedError):
        bench.switch(start, stop)
    assert bench.switch(start, stop, BEST_EFFORT).ok

    assert (bench.state("run"), bench.state("idle")) == ("running", "initialized")


@pytest.mark.parametrize("strictness", list(Strictness))
def test_3_an_empty_switch_is_fine(bench, strictness):
    assert bench.switch(strictness=strictness).ok


def test_4_a_refused_rival_does_not_interrupt_who_holds_the_joint(bench):
    arm = bench.load("arm", "j1")
    bench.load("rival", "j1")
    bench.switch(["arm"])
    for _ in range(5):
        with pytest.raises(ResourceConflictError):
            bench.switch(["rival"])
        bench.step()

    assert arm.calls == ["starting"] + ["update"] * 5


def test_4_a_rival_that_fails_to_start_gives_the_joint_back(bench):
    arm = bench.load("arm", "j1")
    rival = bench.load("rival", "j1")
    bench.switch(["arm"])
    rival.actions["starting"] = lambda: 1 / 0

    with pytest.raises(SwitchRefusedError, match="division"):
        bench.switch(["rival"], ["arm"])
    bench.step()

    assert bench.state("arm") == "running"
    assert arm.calls[-1] == "update"


def test_5_two_of_one_start_list_that_conflict_are_refused_before_anything(bench):
    bench.load("arm", "j1")
    bench.load("rival", "j1")

    with pytest.raises(ResourceConflictError):
        bench.switch(["arm", "rival"])

    assert bench.robot.switches == []
    assert bench.manager.cycle == 0


def test_6_a_start_that_raises_is_reported_frees_the_joint_and_can_be_retried(bench):
    arm, other = bench.load("arm", "j1"), bench.load("other", "j1")
    arm.actions["starting"] = lambda: 1 / 0
    with pytest.raises(SwitchRefusedError, match="ZeroDivisionError"):
        bench.switch(["arm"])
    assert bench.fault("arm").startswith("starting raised")

    assert bench.switch(["other"]).ok
    arm.actions.clear()
    assert bench.switch(["arm"], ["other"]).ok

    assert other.calls == ["starting", "update", "stopping"]


def test_7_hardware_that_refuses_never_leaves_a_controller_listed_as_running(bench):
    bench.load("arm", "j1")
    bench.robot.script.failing = {"arm"}

    result = bench.switch(["arm"])

    assert not result.ok
    assert [s.state.value for s in bench.manager.list_controllers()] == ["aborted"]
    bench.robot.script.failing = set()
    bench.robot.script.refusal = "user stop"
    with pytest.raises(SwitchRefusedError, match="user stop"):
        bench.switch(["arm"])
    assert bench.state("arm") == "aborted"


def test_9_loading_twice_at_once_loads_once(bench):
    bench.parameters.set("arm", {"type": "test/Effort", "joints": ["j1"]})
    outcomes = []

    def load():
        try:
            bench.manager.load_controller("arm")
            outcomes.append("loaded")
        except ControllerExistsError:
            outcomes.append("exists")

    threads = [threading.Thread(target=load) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert sorted(outcomes) == ["exists"] * 7 + ["loaded"]
    assert len(bench.manager.list_controllers()) == 1


def test_9_claims_of_concurrent_loads_do_not_mix(bench):
    def load(number):
        bench.load(f"c{number}", f"j{number}")

    threads = [threading.Thread(target=load, args=(n,)) for n in (1, 2, 3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    claims = {
        status.name: status.claimed_resources[0].resources
        for status in bench.manager.list_controllers()
    }
    assert claims == {"c1": ("j1",), "c2": ("j2",), "c3": ("j3",)}


def test_9_a_running_controller_is_not_unloaded(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])

    with pytest.raises(ControllerStateError, match="running"):
        bench.manager.unload_controller("arm")


def test_9_a_retry_after_a_time_out_finds_a_clean_manager(bench):
    bench.load("arm", "j1")
    bench.manager.pump = None
    for _ in range(3):
        with pytest.raises(SwitchTimeoutError):
            bench.switch(["arm"], timeout=0.1)
    bench.manager.pump = bench.step

    bench.step(3)

    assert bench.state("arm") == "initialized"
    assert bench.switch(["arm"]).ok


@pytest.mark.parametrize(
    "action",
    [
        lambda _: 1 / 0,
        lambda arm: arm.command(math.nan),
        lambda arm: arm.command(math.inf),
        lambda arm: arm.joints[5],
    ],
    ids=["exception", "nan", "inf", "wrong length"],
)
def test_10_a_fault_stops_only_its_controller_safely_with_its_fallback(bench, action):
    bad = bench.load("bad", "j1", fallback=["hold"])
    good = bench.load("good", "j2", fallback=["never"])
    bench.load("hold", "j1")
    bench.load("never", "j2")
    bench.switch(["bad", "good"])
    bench.step()
    bad.actions["update"] = lambda: action(bad)

    bench.step(3)

    states = {s.name: s.state.value for s in bench.manager.list_controllers()}
    assert states == {
        "bad": "aborted",
        "good": "running",
        "hold": "running",
        "never": "initialized",
    }
    assert good.calls.count("update") == 4
    assert all(math.isfinite(x) for x in bench.robot.joints.effort_command)


def test_11_a_command_between_start_and_first_update_is_not_lost(bench):
    arm = bench.load("arm", "j1")
    arm.set_points = SetPointPort([SetPointElement("j1", "Nm")])
    taken = []
    arm.actions["update"] = lambda: taken.append(arm.set_points.take())
    bench.switch(["arm"])
    arm.set_points.post([0.5])

    bench.step(2)

    assert taken == [[0.5], None]
