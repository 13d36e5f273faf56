"""A failing controller hurts nobody else, and a started one does not jump."""

import math

import pytest

from station.core.control.switching import Strictness
from station.core.errors import StoppedError, SwitchRefusedError
from station.testing.scripted import ScriptedBench

BEST_EFFORT = Strictness.BEST_EFFORT


@pytest.fixture
def bench():
    return ScriptedBench()


def fail():
    raise RuntimeError("broken gear")


def test_an_exception_of_update_stops_that_controller_alone(bench):
    bad, good = bench.load("bad", "j1"), bench.load("good", "j2")
    bench.switch(["bad", "good"])
    bad.actions["update"] = fail

    bench.step(3)

    assert bench.state("bad") == "aborted"
    assert bench.state("good") == "running"
    assert good.calls.count("update") == 3
    assert bad.calls == ["starting", "update", "aborting"]


class Unprintable(Exception):  # noqa: N818 - a plugin's own
    """Raises when it is to say what it is."""

    def __str__(self):
        raise RuntimeError("no words")


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (SystemExit(3), "SystemExit: 3"),
        (Unprintable(), "Unprintable: (its text cannot be read)"),
        (OSError("file \udc80"), "OSError: file \\udc80"),
    ],
)
def test_whatever_update_raises_stops_that_controller_alone(bench, error, told):
    def give_up():
        raise error

    bad = bench.load("bad", "j1")
    bench.load("good", "j2")
    bench.switch(["bad", "good"])
    bad.actions["update"] = give_up

    bench.step(3)

    assert bench.state("bad") == "aborted"
    assert bench.state("good") == "running"
    assert bench.fault("bad") == f"update raised {told}"


def test_the_fault_says_what_happened_with_its_traceback(bench):
    bench.load("bad", "j1").actions["update"] = fail
    bench.switch(["bad"])

    bench.step()

    (status,) = bench.manager.list_controllers()
    assert status.fault == "update raised RuntimeError: broken gear"
    assert "in fail" in status.traceback


def test_the_joints_of_a_failed_controller_rest_in_the_same_cycle(bench):
    bad = bench.load("bad", "j1")
    bench.switch(["bad"])
    bad.actions["update"] = lambda: bad.command(2.0)
    bench.step(2)
    assert bench.robot.joints.effort[0] == 2.0
    bad.actions["update"] = lambda: (bad.command(3.0), fail())

    bench.step()

    assert bench.robot.joints.effort_command[0] == 0.0
    assert bench.robot.switches[-1] == ((), ("bad",))
    bench.step()
    assert bench.robot.joints.effort[0] == 0.0


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_not_finite_stops_its_controller(bench, value):
    bad = bench.load("bad", "j1", "j2")
    bench.switch(["bad"])
    bad.actions["update"] = lambda: bad.command(value)

    bench.step()

    assert bench.state("bad") == "aborted"
    assert f"command {value!r} for 'j1'" in bench.fault("bad")
    assert bench.robot.joints.effort_command == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("value", ["1.0", None, [1.0]])
def test_a_command_that_is_no_number_stops_its_controller(bench, value):
    bad = bench.load("bad", "j1")
    bench.switch(["bad"])
    bad.actions["update"] = lambda: bad.command(value)

    bench.step()

    assert bench.state("bad") == "aborted"
    assert bench.robot.joints.effort_command[0] == 0.0


def test_a_large_finite_sum_is_no_fault(bench):
    strong = bench.load("strong", "j1", "j2", allow_start_jump=True)
    bench.switch(["strong"])
    strong.actions["update"] = lambda: strong.command(1.5e308)

    bench.manager.update(1.0, 0.01)

    assert bench.state("strong") == "running"


def test_a_failed_controller_can_be_started_again(bench):
    bad = bench.load("bad", "j1")
    bench.switch(["bad"])
    bad.actions["update"] = fail
    bench.step()
    bad.actions.clear()

    assert bench.switch(["bad"]).ok

    assert bench.state("bad") == "running"
    assert bench.fault("bad") is None


def test_an_exception_of_stopping_does_not_keep_it_running(bench):
    bench.load("bad", "j1").actions["stopping"] = fail
    bench.switch(["bad"])

    assert bench.switch(stop=["bad"]).ok

    assert bench.state("bad") == "stopped"
    assert "stopping raised" in bench.fault("bad")


@pytest.mark.parametrize("callback", ["starting", "waiting", "aborting"])
def test_an_exception_of_any_other_callback_is_contained(bench, callback):
    bad, good = bench.load("bad", "j1"), bench.load("good", "j2")
    bench.switch(["good"])
    bench.robot.script.switch_cycles = 2
    bench.robot.script.failing = {"bad"} if callback == "aborting" else set()
    bad.actions[callback] = fail

    result = bench.switch(["bad"], strictness=BEST_EFFORT)

    assert not result.ok
    assert result.failed["bad"]
    assert bench.state("bad") == "aborted"
    assert bench.state("good") == "running"
    assert f"{callback} raised" in bench.fault("bad")
    assert "update" in good.calls


def test_a_strict_switch_is_taken_back_when_a_start_fails(bench):
    old, other = bench.load("old", "j1"), bench.load("other", "j2")
    bench.load("new", "j1").actions["starting"] = fail
    bench.switch(["old"])

    with pytest.raises(SwitchRefusedError, match=r"'new' did not start.*broken gear"):
        bench.switch(["other", "new"], ["old"])

    assert bench.state("old") == "running"
    assert bench.state("other") == "stopped"
    assert bench.state("new") == "aborted"
    assert bench.robot.joints.mode == [
        "hardware_interface::EffortJointInterface",
        "",
        "",
    ]
    assert old.calls[-2:] == ["stopping", "starting"]
    assert other.calls == ["starting", "stopping"]


def test_a_controller_that_begins_where_the_robot_rests_does_not_jump(bench):
    bench.load("arm", "j1", "j2")

    assert bench.switch(["arm"]).jump == {"j1": 0.0, "j2": 0.0}


@pytest.mark.parametrize(
    ("kind", "allowed", "excessive"),
    [("Effort", 4.9, 5.1), ("Velocity", 0.049, 0.051), ("Position", 0.009, 0.011)],
)
def test_a_first_command_may_jump_only_so_far(bench, kind, allowed, excessive):
    arm = bench.load("arm", "j1", kind=kind)
    arm.actions["starting"] = lambda: arm.command(excessive)
    with pytest.raises(SwitchRefusedError, match="'j1' jumps") as caught:
        bench.switch(["arm"])
    assert caught.value.details["jump"] == {"j1": excessive}
    assert bench.state("arm") == "aborted"
    arm.actions["starting"] = lambda: arm.command(allowed)

    result = bench.switch(["arm"])

    assert result.jump == {"j1": allowed}
    assert bench.state("arm") == "running"


def test_the_command_of_the_first_update_may_not_jump_either(bench):
    arm = bench.load("arm", "j1")
    arm.actions["update"] = lambda: arm.command(20.0)
    bench.switch(["arm"])

    bench.step()

    assert bench.state("arm") == "aborted"
    assert "jumps by 20" in bench.fault("arm")
    assert bench.robot.joints.effort[0] == 0.0


def test_later_commands_may_be_anything(bench):
    arm = bench.load("arm", "j1")
    bench.switch(["arm"])
    bench.step()
    arm.actions["update"] = lambda: arm.command(20.0)

    bench.step()

    assert bench.state("arm") == "running"


def test_a_jump_can_be_allowed(bench):
    arm = bench.load("arm", "j1", allow_start_jump=True)
    arm.actions["starting"] = lambda: arm.command(20.0)

    assert bench.switch(["arm"]).jump == {"j1": 20.0}


def test_a_successor_may_go_on_from_the_last_command_or_from_rest(bench):
    first = bench.load("first", "j1")
    second, third = bench.load("second", "j1"), bench.load("third", "j1")
    bench.switch(["first"])
    bench.step()
    first.actions["update"] = lambda: first.command(20.0)
    bench.step()
    second.actions["starting"] = lambda: second.command(21.0)
    assert bench.switch(["second"], ["first"]).jump == {"j1": 1.0}
    third.actions["starting"] = lambda: third.command(0.5)

    assert bench.switch(["third"], ["second"]).jump == {"j1": 0.5}


def test_a_command_of_long_ago_does_not_reach_the_robot(bench):
    bench.load("first", "j1", kind="Position")
    bench.load("second", "j1", kind="Velocity", allow_start_jump=True)
    third = bench.load("third", "j1", kind="Position")
    bench.switch(["first"])
    bench.switch(["second"], ["first"])
    bench.robot.joints.velocity_command[0] = 1.0
    bench.step(50)
    bench.switch(["third"], ["second"])

    bench.step()

    assert bench.robot.joints.position[0] > 0.4
    assert "update" in third.calls


def test_a_joint_of_unknown_state_is_not_started(bench):
    bench.load("arm", "j1", kind="Position")
    bench.robot.script.nan_sensors = {"j1"}

    with pytest.raises(SwitchRefusedError, match="'j1' is not finite"):
        bench.switch(["arm"])

    assert math.isfinite(bench.robot.joints.position_command[0])


def test_nan_sensors_never_become_nan_commands(bench):
    arm = bench.load("arm", "j1", kind="Position")
    bench.switch(["arm"])
    arm.actions["update"] = lambda: arm.command(arm.joints[0].get_position())
    bench.robot.script.nan_sensors = {"j1"}

    bench.step(2)

    assert bench.state("arm") == "aborted"
    assert bench.robot.joints.position[0] == 0.0


def test_the_fallback_takes_over_in_the_same_cycle(bench):
    bad = bench.load("bad", "j1", fallback=["hold"])
    hold = bench.load("hold", "j1")
    bench.switch(["bad"])
    bad.actions["update"] = fail

    bench.step()

    assert bench.state("bad") == "aborted"
    assert bench.state("hold") == "running"
    assert hold.calls[0] == "starting"
    assert bench.robot.switches[-1] == (("hold",), ())


def test_only_the_fallback_of_the_failed_controller_is_started(bench):
    bad = bench.load("bad", "j1", fallback=["hold1"])
    bench.load("hold1", "j1")
    bench.load("fine", "j2", fallback=["hold2"])
    bench.load("hold2", "j2")
    bench.switch(["bad", "fine"])
    bad.actions["update"] = fail

    bench.step()

    assert bench.state("hold2") == "initialized"
    assert bench.state("fine") == "running"


def test_a_fallback_in_conflict_is_left_out_and_the_joint_rests(bench):
    bad = bench.load("bad", "j1", fallback=["both"])
    bench.load("other", "j2")
    bench.load("both", "j1", "j2")
    bench.switch(["bad", "other"])
    bad.actions["update"] = fail

    bench.step()

    assert bench.state("both") == "initialized"
    assert "no fallback" in bench.fault("bad")
    assert "'j2'" in bench.fault("bad")


def test_a_fallback_that_fails_leaves_the_joint_at_rest(bench):
    bad = bench.load("bad", "j1", fallback=["hold"])
    hold = bench.load("hold", "j1", fallback=["last"])
    bench.load("last", "j1")
    bench.switch(["bad"])
    bad.actions["update"] = lambda: (bad.command(3.0), fail())
    hold.actions["starting"] = fail

    bench.step()

    assert bench.state("hold") == "aborted"
    assert bench.state("last") == "initialized"
    assert bench.robot.joints.effort_command[0] == 0.0
    assert "did not start" in bench.fault("bad")


def fail_in_turn(bench, *names):
    """Load controllers that fail; each has the next one as its fallback."""
    for name, fallback in zip(names, (*names[1:], names[0]), strict=True):
        one = bench.load(name, "j1", fallback=[fallback])
        one.actions["update"] = lambda one=one: (one.command(3.0), fail())
    bench.switch([names[0]])


@pytest.mark.parametrize("names", [("a", "b"), ("b", "a"), ("a", "b", "c")])
def test_fallbacks_that_all_fail_do_not_take_turns(bench, names):
    fail_in_turn(bench, *names)

    bench.step(10)

    starts = [start for start, _ in bench.robot.switches if start]
    assert starts == [(name,) for name in names]
    assert [bench.state(name) for name in names] == ["aborted"] * len(names)
    assert bench.robot.joints.effort_command[0] == 0.0
    last, first = names[-1], names[0]
    assert f"'{last}' stands in for '{first}', which has failed" in bench.fault(last)


def test_a_switch_lets_a_failed_controller_be_a_fallback_again(bench):
    fail_in_turn(bench, "a", "b")
    bench.step(10)

    bench.switch(["b"])
    bench.step(1)

    assert bench.state("b") == "aborted"
    assert bench.state("a") == "running"
    assert "stands in" not in bench.fault("b")


def test_an_unknown_fallback_is_said_and_does_no_harm(bench):
    bench.load("bad", "j1", fallback=["nobody"]).actions["update"] = fail
    bench.switch(["bad"])

    bench.step()

    assert "no fallback: 'nobody' not loaded" in bench.fault("bad")


def test_a_closed_gate_keeps_the_fallback_from_starting(bench):
    bad = bench.load("bad", "j1", fallback=["hold"])
    bench.load("hold", "j1")
    bench.switch(["bad"])
    bad.actions["update"] = fail

    def closed():
        raise StoppedError("stopped")

    bench.manager.lifecycle.start_gate = closed

    bench.step()

    assert bench.state("hold") == "initialized"
