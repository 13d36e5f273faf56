"""What one cycle does, in which order; the recorded runs cover the rest."""

import pytest

from station.core.control.controller import ControllerSample
from station.core.control.controller_update import milliseconds
from station.core.control.switching import Strictness
from station.core.errors import StoppedError, SwitchRefusedError
from station.core.ports.set_point import SetPointElement, SetPointPort
from station.testing.scripted import ScriptedBench

BEST_EFFORT = Strictness.BEST_EFFORT


@pytest.fixture
def bench():
    return ScriptedBench()


def test_a_controller_is_updated_for_the_last_time_in_the_cycle_that_stops_it(bench):
    arm = bench.load("arm", "j1")
    bench.switch(["arm"])

    bench.switch(stop=["arm"])

    assert arm.calls == ["starting", "update", "stopping"]


def test_hardware_and_controllers_switch_in_the_same_cycle(bench):
    old, new = bench.load("old", "j1"), bench.load("new", "j1", kind="Velocity")
    bench.switch(["old"])
    cycle = bench.manager.cycle
    modes = []
    old.actions["stopping"] = new.actions["starting"] = lambda: modes.append((
        bench.manager.cycle,
        bench.robot.joints.mode[0],
    ))

    result = bench.switch(["new"], ["old"])

    velocity = "hardware_interface::VelocityJointInterface"
    assert modes == [(cycle + 1, velocity)] * 2
    assert result.cycle == cycle + 1


def test_controllers_wait_while_the_hardware_switches(bench):
    arm = bench.load("arm", "j1")
    bench.robot.script.switch_cycles = 3

    assert bench.switch(["arm"]).ok

    assert arm.calls == ["waiting", "waiting", "waiting", "starting"]


def test_a_switch_that_the_hardware_cannot_do_says_so(bench):
    bench.load("arm", "j1")
    bench.robot.script.failing = {"arm"}

    result = bench.switch(["arm"])

    assert not result.ok
    assert result.failed == {"arm": "the hardware could not switch"}
    assert result.started == ()
    assert bench.state("arm") == "aborted"


def test_as_soon_as_possible_lets_one_run_while_another_waits(bench):
    fast, slow = bench.load("fast", "j1"), bench.load("slow", "j2")
    bench.switch(["fast"])
    bench.switch(stop=["fast"])
    bench.robot.script.failing = {"slow"}

    result = bench.switch(["fast", "slow"], start_asap=True)

    assert result.started == ("fast",)
    assert set(result.failed) == {"slow"}
    assert "starting" not in slow.calls
    assert fast.calls[-1] == "starting"


def test_a_switch_takes_at_most_its_timeout_in_station_time(bench):
    arm = bench.load("arm", "j1")
    bench.robot.script.switch_cycles = 1000

    result = bench.switch(["arm"], timeout=0.1)

    assert result.failed == {"arm": "the hardware was not ready in time"}
    assert arm.calls == ["waiting"] * 10 + ["aborting"]


def test_a_hook_of_the_hardware_that_raises_ends_the_switch_and_not_the_loop(bench):
    bench.load("arm", "j1")

    def broken():
        raise RuntimeError("no bus")

    bench.robot.switch_result = broken

    result = bench.switch(["arm"])

    assert "switch_result raised RuntimeError: no bus" in result.failed["arm"]
    bench.step()


def test_hardware_that_cannot_begin_to_switch_aborts_the_start(bench):
    bench.load("arm", "j1")

    def broken(*_):
        raise RuntimeError("no bus")

    bench.robot.do_switch = broken

    result = bench.switch(["arm"])

    assert "do_switch raised" in result.failed["arm"]
    assert bench.state("arm") == "aborted"


def test_a_closed_gate_refuses_to_start_and_lets_stop(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])

    def closed():
        raise StoppedError("stopped")

    bench.manager.lifecycle.start_gate = closed

    assert bench.switch(stop=["arm"]).ok
    with pytest.raises(StoppedError):
        bench.switch(["arm"])
    assert bench.state("arm") == "stopped"
    assert bench.robot.switches[-1] == ((), ("arm",))


def test_stopping_everything_rests_the_robot(bench):
    arm, other = bench.load("arm", "j1"), bench.load("other", "j2")
    bench.switch(["arm", "other"])
    bench.step()
    arm.actions["update"] = lambda: arm.command(3.0)
    bench.step()

    bench.manager.stop_all(bench.time)

    assert bench.state("arm") == bench.state("other") == "stopped"
    assert arm.calls[-1] == other.calls[-1] == "stopping"
    assert bench.robot.joints.effort_command == [0.0, 0.0, 0.0]
    assert bench.robot.switches[-1] == ((), ("arm", "other"))


def test_stopping_everything_ends_a_switch_under_way(bench):
    bench.load("arm", "j1")
    bench.robot.script.switch_cycles = 1000
    cycles = []

    def pump():
        bench.step()
        cycles.append(bench.state("arm"))
        if len(cycles) == 3:
            bench.manager.stop_all(bench.time)

    bench.manager.pump = pump

    with pytest.raises(SwitchRefusedError, match="Everything was stopped"):
        bench.switch(["arm"])

    bench.manager.pump = bench.step
    bench.robot.script.switch_cycles = 0
    assert cycles == ["waiting"] * 3
    assert bench.robot.joints.mode == ["", "", ""]
    assert bench.state("arm") == "aborted"
    assert bench.switch(["arm"]).ok


def test_reset_stops_starts_and_updates_what_runs(bench):
    arm = bench.load("arm", "j1")
    bench.switch(["arm"])
    switches = len(bench.robot.switches)

    bench.manager.update(1.0, 0.01, reset_controllers=True)

    assert arm.calls == ["starting", "stopping", "starting", "update"]
    assert len(bench.robot.switches) == switches


def test_samples_are_those_of_running_controllers(bench):
    arm, _ = bench.load("arm", "j1"), bench.load("idle", "j2")
    sample = ControllerSample(1.0, [0.0], [0.0], [0.0], [0.0])
    bench.switch(["arm"])
    assert bench.manager.samples() == {}
    arm.sample = sample

    assert bench.manager.samples() == {"arm": sample}


def test_voided_commands_are_not_picked_up(bench):
    arm = bench.load("arm", "j1")
    arm.set_points = SetPointPort([SetPointElement("j1", "Nm")])
    arm.set_points.post([1.0])

    bench.manager.lifecycle.void_commands("A reset.")

    assert arm.set_points.take() is None


def test_a_set_point_before_the_first_update_is_no_jump(bench):
    arm = bench.load("arm", "j1")
    arm.set_points = SetPointPort([SetPointElement("j1", "Nm")])

    def follow():
        values = arm.set_points.take()
        if values is not None:
            arm.command(values[0])

    arm.actions["update"] = follow
    bench.switch(["arm"])
    arm.set_points.post([20.0])

    bench.step()

    assert bench.state("arm") == "running"
    assert bench.robot.joints.effort_command[0] == 20.0


class Stopwatch:
    """A clock by which every update takes as long as the test says."""

    def __init__(self):
        self.now = 0.0
        self.duration = 0.0

    def __call__(self):
        self.now += self.duration
        return self.now


@pytest.fixture
def stopwatch(bench):
    bench.manager.controller_update.stopwatch = stopwatch = Stopwatch()
    return stopwatch


def test_a_controller_that_keeps_taking_too_long_is_stopped_alone(bench, stopwatch):
    bench.load("slow", "j1", fallback=["hold"])
    bench.load("hold", "j1")
    bench.switch(["slow"])
    bench.manager.controller_update.update_budget = 0.001
    stopwatch.duration = 0.002

    bench.step(99)
    assert bench.state("slow") == "running"
    bench.step()

    assert bench.state("slow") == "aborted"
    assert "update took 2 ms, 100 in a row" in bench.fault("slow")
    assert "at most 1 ms" in bench.fault("slow")
    assert bench.state("hold") == "running"


def test_a_controller_that_is_late_now_and_then_goes_on(bench, stopwatch):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    bench.manager.controller_update.update_budget = 0.001
    for cycle in range(500):
        stopwatch.duration = 0.0 if cycle % 50 == 0 else 0.002
        bench.step()

    assert bench.state("arm") == "running"


def _stall(bench, stopwatch):
    """Let one update take a quarter of a second, and the next one no time."""
    stopwatch.duration = 0.25
    bench.step()
    stopwatch.duration = 0.0
    bench.step()


def test_two_updates_of_a_quarter_of_a_second_are_enough(bench, stopwatch):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    bench.manager.controller_update.update_budget = 0.001

    _stall(bench, stopwatch)
    assert bench.state("arm") == "running"
    _stall(bench, stopwatch)

    assert bench.state("arm") == "aborted"
    assert "took 250 ms, and one within 10 s before it as long" in bench.fault("arm")


def test_a_machine_that_stalls_now_and_then_stops_no_controller(bench, stopwatch):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    bench.manager.controller_update.update_budget = 0.001
    for _ in range(3):
        _stall(bench, stopwatch)
        bench.step(11_000)
    assert bench.state("arm") == "running"

    _stall(bench, stopwatch)
    bench.switch(stop=["arm"])
    bench.switch(["arm"])
    _stall(bench, stopwatch)
    assert bench.state("arm") == "running"


def test_stepped_cycles_have_all_the_time_they_want(bench, stopwatch):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    stopwatch.duration = 10.0

    bench.step(200)

    assert bench.state("arm") == "running"


@pytest.mark.parametrize(
    ("duration", "text"),
    [
        (2.0, "2000 ms"),
        (0.9999, "1000 ms"),
        (0.0999, "99.9 ms"),
        (0.002, "2 ms"),
        (0.00001234, "0.0123 ms"),
        (4321.0, "4321000 ms"),
    ],
)
def test_durations_are_told_in_digits(duration, text):
    assert milliseconds(duration) == text
