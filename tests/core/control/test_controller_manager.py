"""Callers of the manager: refused with reasons, served in turn, never stuck."""

import threading

import pytest

from station.core.clock import SystemClock
from station.core.control.controller_loader import TableLoader
from station.core.control.switching import Strictness, SwitchRequest
from station.core.errors import (
    ControllerExistsError,
    ControllerNotFoundError,
    ControllerStateError,
    ResourceConflictError,
    SwitchRefusedError,
    SwitchTimeoutError,
)
from station.core.loop.control_loop import ControlLoop
from station.testing.scripted import Scripted, ScriptedBench
from tests.waiting import PATIENCE

BEST_EFFORT = Strictness.BEST_EFFORT


@pytest.fixture
def bench():
    return ScriptedBench()


@pytest.fixture
def frozen(bench):
    """A bench on which nobody runs cycles."""
    bench.manager.pump = None
    return bench


@pytest.fixture
def threaded():
    """A bench whose cycles run in the control thread."""
    bench = ScriptedBench(SystemClock())
    loop = ControlLoop(bench.robot, bench.manager, clock=SystemClock())
    loop.start()
    yield bench
    loop.stop()


def test_loading_a_name_twice_leaves_the_first_alone(bench):
    first = bench.load("arm", "j1")

    with pytest.raises(ControllerExistsError, match="'arm' is loaded already"):
        bench.manager.load_controller("arm")

    assert bench.manager.get_controller("arm") is first


def test_unloading_frees_the_name_and_forgets_the_parameters(bench):
    first = bench.load("arm", "j1")

    bench.manager.unload_controller("arm")
    second = bench.load("arm", "j2")

    assert second is not first
    assert [joint.name for joint in second.joints] == ["j2"]


def test_unloading_what_is_not_loaded_is_refused(bench):
    bench.load("arm")

    with pytest.raises(ControllerNotFoundError, match="No controller 'leg'") as caught:
        bench.manager.unload_controller("leg")

    assert caught.value.remedy == "There are: arm."


def test_unloading_what_runs_is_refused_and_it_runs_on(bench):
    arm = bench.load("arm", "j1")
    bench.switch(["arm"])

    with pytest.raises(ControllerStateError, match="'arm' cannot be unloaded"):
        bench.manager.unload_controller("arm")

    bench.step()
    assert arm.calls[-1] == "update"


def test_a_refused_unload_can_be_repeated(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    with pytest.raises(ControllerStateError):
        bench.manager.unload_controller("arm")
    bench.switch(stop=["arm"])

    bench.manager.unload_controller("arm")

    assert bench.manager.list_controllers() == []


def test_loading_and_unloading_need_no_cycle(frozen):
    frozen.step()

    frozen.load("arm", "j1")
    frozen.manager.unload_controller("arm")

    assert frozen.manager.cycle == 1


def test_a_conflict_names_the_resource_and_its_holder(bench):
    bench.load("arm", "j1", "j2")
    bench.load("rival", "j2", kind="Velocity")
    bench.switch(["arm"])

    with pytest.raises(ResourceConflictError, match="'j2' is claimed by") as caught:
        bench.switch(["rival"])

    (conflict,) = caught.value.details["conflicts"]
    assert conflict["resource"] == "j2"
    assert conflict["held_by"] == "arm"
    assert caught.value.details["held_by"] == ["arm"]
    assert "'arm'" in caught.value.remedy


def test_a_dry_run_tells_the_plan_and_changes_nothing(bench):
    bench.load("arm", "j1")
    bench.load("rival", "j1")
    bench.switch(["arm"])
    cycle, switches = bench.manager.cycle, len(bench.robot.switches)

    result = bench.switch(["rival"], ["arm"], dry_run=True)

    assert result.dry_run
    assert (result.started, result.stopped) == (("rival",), ("arm",))
    assert (bench.manager.cycle, len(bench.robot.switches)) == (cycle, switches)
    assert bench.state("arm") == "running"


def test_a_dry_run_is_refused_like_the_real_one(bench):
    bench.load("arm", "j1")
    bench.load("rival", "j1")
    bench.switch(["arm"])

    with pytest.raises(ResourceConflictError):
        bench.switch(["rival"], dry_run=True)


@pytest.mark.parametrize("timeout", [0.0, 0.2])
def test_without_cycles_a_switch_is_withdrawn_at_its_deadline(frozen, timeout):
    frozen.load("arm", "j1")
    before = frozen.clock.now()

    with pytest.raises(SwitchTimeoutError, match="withdrawn") as caught:
        frozen.switch(["arm"], timeout=timeout)

    assert caught.value.details["begun"] is False
    assert frozen.clock.now() - before <= 5.1
    frozen.step()
    assert frozen.robot.switches == []
    assert frozen.state("arm") == "initialized"


def test_after_a_withdrawn_switch_the_next_one_works(frozen):
    frozen.load("arm", "j1")
    with pytest.raises(SwitchTimeoutError):
        frozen.switch(["arm"])
    frozen.manager.pump = frozen.step

    assert frozen.switch(["arm"]).ok


def test_a_loop_that_freezes_in_the_middle_ends_the_switch_when_it_goes_on(bench):
    bench.load("arm", "j1")
    bench.robot.script.switch_cycles = 1000

    def pump_once():
        bench.step_elsewhere()
        bench.manager.pump = None

    bench.manager.pump = pump_once
    with pytest.raises(SwitchTimeoutError, match="It has begun"):
        bench.switch(["arm"])
    with pytest.raises(SwitchRefusedError, match="not finished"):
        bench.switch(["arm"])

    bench.step_elsewhere()

    assert bench.state("arm") == "aborted"
    bench.robot.script.switch_cycles = 0
    bench.manager.pump = bench.step
    assert bench.switch(["arm"]).ok


def test_hardware_that_never_gets_ready_is_given_up(bench):
    bench.load("arm", "j1")
    bench.robot.script.switch_cycles = 10**9

    result = bench.switch(["arm"])

    assert result.failed == {"arm": "the hardware was not ready in time"}
    assert 4.9 < bench.time < 5.2
    assert bench.robot.joints.mode == ["", "", ""]


def test_an_error_of_a_pumped_cycle_withdraws_the_switch(bench):
    bench.load("arm", "j1")

    def broken():
        raise OSError("no bus")

    bench.manager.pump = broken
    with pytest.raises(OSError, match="no bus"):
        bench.switch(["arm"])
    bench.manager.pump = bench.step

    assert bench.switch(["arm"]).ok


@pytest.mark.parametrize("callback", ["starting", "update", "stopping"])
def test_a_switch_from_within_a_callback_is_refused(bench, callback):
    arm = bench.load("arm", "j1")
    bench.load("other", "j2")
    errors = []

    def switch():
        try:
            bench.switch(["other"])
        except ControllerStateError as error:
            errors.append(error)

    arm.actions[callback] = switch
    bench.switch(["arm"])
    bench.step()
    bench.switch(stop=["arm"])

    assert "wait for itself" in errors[0].message
    assert bench.state("other") == "initialized"


def test_a_switch_from_the_thread_of_a_loop_without_a_pump_is_refused(frozen):
    frozen.load("arm", "j1")
    frozen.step()

    with pytest.raises(ControllerStateError, match="control thread") as caught:
        frozen.switch(["arm"])

    assert "pump" in caught.value.remedy


def test_a_switch_waits_for_the_control_thread(threaded):
    threaded.load("arm", "j1")

    result = threaded.switch(["arm"])

    assert result.ok
    assert result.cycle > 0
    assert threaded.state("arm") == "running"


def test_callers_are_served_one_after_the_other(threaded):
    names = [f"c{number}" for number in range(8)]
    for name in names:
        threaded.load(name)
    failures = []

    def switch(name):
        result = threaded.switch([name])
        if not result.ok or threaded.state(name) != "running":
            failures.append(name)

    threads = [threading.Thread(target=switch, args=(name,)) for name in names]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)

    assert failures == []
    assert all(threaded.state(name) == "running" for name in names)


def test_a_loader_can_be_added(bench):
    bench.manager.register_loader(TableLoader({"late/Type": Scripted}, "late_base"))
    bench.parameters.set("late/type", "late/Type")

    bench.manager.load_controller("late")

    assert ("late/Type", "late_base") in bench.manager.list_controller_types()


def test_reloading_with_controllers_is_refused(bench):
    bench.load("arm")

    with pytest.raises(ControllerStateError, match="arm"):
        bench.manager.reload_controller_libraries()

    assert len(bench.manager.list_controllers()) == 1


def test_a_forced_reload_stops_and_unloads_everything(bench):
    arm = bench.load("arm", "j1")
    bench.load("idle")
    bench.switch(["arm"])

    bench.manager.reload_controller_libraries(force_kill=True)

    assert arm.calls[-1] == "stopping"
    assert bench.manager.list_controllers() == []


def test_a_forced_reload_that_cannot_stop_everything_unloads_nothing(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    bench.robot.script.refusal = "the arm is lifting a load"

    with pytest.raises(SwitchRefusedError, match="lifting a load"):
        bench.manager.reload_controller_libraries(force_kill=True)

    assert bench.state("arm") == "running"


def test_the_running_controllers_are_told_with_their_claims(bench):
    bench.load("a", "j1")
    bench.load("b", "j2")
    bench.switch(["b"])

    assert [info.name for info in bench.manager.running()] == ["b"]
    assert bench.manager.running()[0].claimed_resources[0].resources == ("j2",)
    assert not bench.manager.is_switching()


def test_a_switch_that_waits_for_the_hardware_is_told(bench):
    bench.load("a", "j1").actions["waiting"] = lambda: seen.append(
        bench.manager.is_switching()
    )
    seen = []
    bench.robot.script.switch_cycles = 2

    bench.switch(["a"])

    assert seen
    assert all(seen)
    assert not bench.manager.is_switching()


def owners(statuses, joint):
    return [
        one.name
        for one in statuses
        for claimed in one.claimed_resources
        if one.state.value == "running" and joint in claimed.resources
    ]


def test_a_list_that_a_switch_interrupts_shows_one_owner_of_a_joint(bench, monkeypatch):
    first = bench.load("first", "j1")
    bench.load("second", "j1")
    bench.manager.switch_controller(SwitchRequest(["first"]))
    switches = [SwitchRequest(["second"], ["first"])]

    def switch_meanwhile(_values):
        if switches:  # at the end of the first controller's status
            bench.manager.switch_controller(switches.pop())
        return []

    monkeypatch.setattr(first.tunables, "notes", switch_meanwhile)

    assert owners(bench.manager.list_controllers(), "j1") == ["second"]
    assert not switches


def test_a_list_in_the_middle_of_a_switch_is_that_of_before(bench, monkeypatch):
    first = bench.load("first", "j1")
    second = bench.load("second", "j1")
    bench.manager.switch_controller(SwitchRequest(["first"]))
    bench.manager.list_controllers()
    seen = []

    def look():
        seen.append(owners(bench.manager.list_controllers(), "j1"))

    def starting(_time):
        assert first.state.value == "stopped"
        reader = threading.Thread(target=look)
        reader.start()
        reader.join()

    monkeypatch.setattr(second, "starting", starting)
    bench.manager.switch_controller(SwitchRequest(["second"], ["first"]))

    assert seen == [["first"]]
    assert owners(bench.manager.list_controllers(), "j1") == ["second"]
