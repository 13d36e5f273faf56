"""Nothing but real finite floats of their owners, or rest, ever reaches the robot."""

import contextlib
import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from station.core.control.switching import Strictness
from station.core.errors import StationError, SwitchRefusedError
from station.core.hardware.interfaces import EffortJointInterface
from station.testing.scripted import ScriptedBench

BEST_EFFORT = Strictness.BEST_EFFORT
REFUSED = [
    (-0.0001) ** 0.5,
    0j,
    complex(math.nan, 1.0),
    10**400,
    10**5000,
    Decimal(1),
    Decimal("NaN"),
    "1.0",
    None,
    [1.0],
    math.nan,
    math.inf,
    np.float64("nan"),
    np.array([1.0, 2.0]),
]


class Written:
    """Notes what reaches the robot in every write."""

    def __init__(self, bench: ScriptedBench) -> None:
        self.efforts: list[list[float]] = []
        self.positions: list[list[float]] = []
        self.velocities: list[list[float]] = []
        write, joints = bench.robot.write, bench.robot.joints

        def watched(time, period):
            self.efforts.append(list(joints.effort_command))
            self.positions.append(list(joints.position_command))
            self.velocities.append(list(joints.velocity_command))
            write(time, period)

        bench.robot.write = watched

    def all(self) -> list[float]:
        rows = (*self.efforts, *self.positions, *self.velocities)
        return [value for row in rows for value in row]


@pytest.fixture
def bench():
    return ScriptedBench()


@pytest.fixture
def written(bench):
    return Written(bench)


@pytest.mark.parametrize("value", REFUSED, ids=map(str, range(len(REFUSED))))
def test_a_command_that_is_no_real_finite_number_stops_its_controller_alone(
    bench, written, value
):
    bad, good = bench.load("bad", "j1", "j3"), bench.load("good", "j2")
    bench.switch(["bad", "good"])
    bench.step()
    bad.actions["update"] = lambda: bad.command(value)

    bench.step(2)

    assert bench.state("bad") == "aborted"
    assert "update" in bench.fault("bad")
    assert len(bench.fault("bad")) < 200
    assert bench.state("good") == "running"
    assert good.calls.count("update") == 3
    assert all(type(value) is float for value in written.all())


@pytest.mark.parametrize("value", REFUSED, ids=map(str, range(len(REFUSED))))
@pytest.mark.parametrize("callback", ["starting", "stopping", "waiting", "aborting"])
def test_no_callback_brings_such_a_command_to_the_robot(
    bench, written, callback, value
):
    bad = bench.load("bad", "j1")
    bench.load("heir", "j1")
    bad.actions[callback] = lambda: bad.command(value)
    bench.robot.script.switch_cycles = 2
    bench.robot.script.failing = {"bad"} if callback == "aborting" else set()

    bench.switch(["bad"], strictness=BEST_EFFORT)
    bench.robot.script.failing = set()
    bench.switch(["heir"], ["bad"], strictness=BEST_EFFORT)
    bench.step(3)

    assert bench.state("heir") == "running"
    assert bench.fault("heir") is None
    assert callback in bench.fault("bad")
    assert set(written.all()) == {0.0}
    assert all(type(value) is float for value in written.all())


@pytest.mark.parametrize(
    "value", [1, True, np.float32(1.0), np.int64(1), np.float64(1.0), Fraction(1)]
)
def test_a_real_number_of_another_type_reaches_the_robot_as_a_float(
    bench, written, value
):
    arm = bench.load("arm", "j1", "j2", allow_start_jump=True)
    bench.switch(["arm"])
    arm.actions["update"] = lambda: arm.joints[0].set_command(value)

    bench.step()

    assert bench.state("arm") == "running"
    assert written.efforts[-1] == [1.0, 0.0, 0.0]
    assert all(type(value) is float for value in written.efforts[-1])


@pytest.mark.parametrize("kind", ["Effort", "Velocity", "Position"])
@pytest.mark.parametrize("callback", ["waiting", "aborting"])
def test_a_controller_that_owns_nothing_moves_nothing(bench, written, callback, kind):
    arm = bench.load("arm", "j1", kind=kind)
    arm.actions[callback] = lambda: arm.command(5.0)
    bench.robot.script.switch_cycles = 2
    bench.robot.script.failing = {"arm"} if callback == "aborting" else set()

    result = bench.switch(["arm"])
    bench.step(100)

    assert not result.ok
    assert f"{callback} wrote the command 5.0 for 'j1'" in bench.fault("arm")
    assert set(written.all()) == {0.0}
    assert bench.robot.joints.position == [0.0, 0.0, 0.0]


def test_what_stopping_commands_is_its_last_word_and_then_the_resource_rests(
    bench, written
):
    arm = bench.load("arm", "j1", kind="Velocity", allow_start_jump=True)
    arm.actions["update"] = lambda: arm.command(0.5)
    arm.actions["stopping"] = lambda: arm.command(0.25)
    bench.switch(["arm"])
    bench.step()
    heir = bench.load("heir", "j1", kind="Velocity")

    assert bench.switch(["heir"], ["arm"]).jump == {"j1": 0.0}
    assert heir.joints[0].get_command() == 0.25
    bench.switch(stop=["heir"])

    assert written.velocities[-1] == [0.0, 0.0, 0.0]


def test_a_joint_that_has_lost_its_owner_holds_its_rest(bench, written):
    arm = bench.load("arm", "j1", kind="Velocity", allow_start_jump=True)
    arm.actions["update"] = lambda: arm.command(0.5)
    bench.switch(["arm"])
    bench.step(10)
    # A robot whose do_switch fails stays in its mode and goes on acting on commands.
    bench.robot.do_switch = lambda *_: 1 / 0

    result = bench.switch(stop=["arm"])
    position = bench.robot.joints.position[0]
    bench.step(500)

    assert not result.ok
    assert "do_switch raised ZeroDivisionError" in result.failed["arm"]
    assert bench.robot.joints.position[0] == position
    assert written.velocities[-1] == [0.0, 0.0, 0.0]


def test_an_unclaimed_command_never_reaches_the_robot_and_its_writer_is_stopped(
    bench, written
):
    stranger, good = bench.load("stranger", "j1"), bench.load("good", "j2")
    bench.switch(["stranger", "good"])
    bench.step()
    handle = bench.robot.get(EffortJointInterface).get_handle("j3")
    stranger.actions["update"] = lambda: handle.set_command(7.0)

    bench.step(20)

    assert bench.state("stranger") == "aborted"
    assert "'j3', which it has not claimed" in bench.fault("stranger")
    assert bench.state("good") == "running"
    assert set(written.all()) == {0.0}
    count, last = bench.manager.command_violations
    assert count > 0
    assert "'j3'" in last
    assert good.calls.count("update") == 21


def test_a_command_over_that_of_another_controller_is_put_back(bench, written):
    owner, thief = bench.load("owner", "j1"), bench.load("thief", "j2")
    bench.switch(["owner", "thief"])
    bench.step()
    owner.actions["update"] = lambda: owner.command(1.0)
    thief.actions["update"] = lambda: owner.joints[0].set_command(9.0)

    bench.step(20)

    assert {row[0] for row in written.efforts} == {0.0, 1.0}
    assert bench.state("thief") == "aborted"
    assert "'owner'" in bench.fault("thief")
    assert bench.state("owner") == "running"


def test_somebody_outside_of_all_controllers_cannot_command_a_free_joint(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    bench.step()
    for _ in range(20):
        bench.robot.joints.effort_command[2] = 4.0
        bench.manager.update(bench.time, 0.01)

        assert bench.robot.joints.effort_command[2] == 0.0

    assert bench.state("arm") == "running"
    count, last = bench.manager.command_violations
    assert count > 0
    assert "'j3'" in last


def test_a_free_joint_keeps_its_rest_while_others_switch(bench):
    bench.load("arm", "j1", kind="Position")
    bench.load("other", "j2")
    bench.switch(["arm"])
    bench.switch(stop=["arm"])
    rest = bench.robot.joints.position_command[0]
    bench.robot.joints.position[0] += 0.001  # sags a little under its load

    bench.switch(["other"])

    assert bench.robot.joints.position_command[0] == rest


def test_a_reset_world_gives_free_joints_a_new_rest(bench):
    bench.load("arm", "j1", kind="Position")
    bench.switch(["arm"])
    bench.switch(stop=["arm"])
    bench.robot.joints.position[0] = 0.7
    bench.robot.read(bench.time, 0.01)

    bench.manager.update(bench.time, 0.01, reset_controllers=True)

    assert bench.robot.joints.position_command[0] == 0.7


@pytest.mark.parametrize("number", [-0.001, math.nan, math.inf, -math.inf])
def test_an_update_refuses_impossible_times_and_periods(bench, number):
    arm = bench.load("arm", "j1")
    bench.switch(["arm"])

    with pytest.raises(ValueError, match="period"):
        bench.manager.update(1.0, number)
    with pytest.raises(ValueError, match="time"):
        bench.manager.update(number, 0.01)

    assert arm.calls == ["starting"]


def test_the_types_of_a_strict_refusal_name_the_command(bench):
    arm = bench.load("arm", "j1")
    arm.actions["starting"] = lambda: arm.command(1 + 2j)

    with pytest.raises(SwitchRefusedError, match=r"\(1\+2j\) for 'j1'"):
        bench.switch(["arm"])


@pytest.mark.parametrize("callback", ["starting", "stopping", "waiting", "aborting"])
@pytest.mark.parametrize("command", [5.0, math.nan, 0j, None])
def test_no_callback_of_a_switch_writes_the_command_of_another(
    bench, callback, command
):
    owner = bench.load("owner", "j1", kind="Velocity")
    intruder = bench.load("intruder", "j2", kind="Velocity")
    owner.actions["update"] = lambda: owner.command(0.04)
    bench.switch(["owner"])
    intruder.actions[callback] = lambda: owner.command(command)
    sent = []
    write = bench.robot.write
    bench.robot.write = lambda time, period: (
        sent.append(bench.robot.joints.velocity_command[0]),
        write(time, period),
    )
    bench.robot.script.switch_cycles = 1

    faults = []
    for start, stop, failing in (
        (["intruder"], [], set()),
        ([], ["intruder"], set()),
        (["intruder"], [], {"intruder"}),
    ):
        bench.robot.script.failing = failing
        with contextlib.suppress(StationError):
            bench.switch(start, stop, timeout=0.05)
        faults.append(bench.fault("intruder") or "")

    assert set(sent) == {0.04}
    assert bench.state("owner") == "running"
    assert any("'j1', which it has not claimed" in fault for fault in faults)


@pytest.mark.parametrize("failures", [[], [True]])
def test_a_robot_that_seeds_its_commands_leaves_those_of_who_runs_on(bench, failures):
    owner = bench.load("owner", "j1", kind="Velocity")
    owner.actions["update"] = lambda: owner.command(0.04)
    bench.load("other", "j2", kind="Velocity")
    bench.switch(["owner"])
    commands, do_switch = bench.robot.joints.velocity_command, bench.robot.do_switch

    def seed(start, stop):
        do_switch(start, stop)
        commands[:] = [0.0] * len(commands)
        if failures:
            failures.clear()
            raise RuntimeError("no bus")

    bench.robot.do_switch = seed
    bench.switch(["other"], ["owner"] if failures else [])

    assert commands[0] == 0.04
    assert bench.state("owner") == "running"


def test_the_update_of_a_restart_writes_no_command_of_another(bench):
    owner = bench.load("owner", "j1", kind="Velocity")
    owner.actions["update"] = lambda: owner.command(0.04)
    bench.load("restarted", "j2").actions["update"] = lambda: owner.command(5.0)
    bench.switch(["owner"])
    sent = []
    bench.robot.write = lambda *_: sent.append(bench.robot.joints.velocity_command[0])

    bench.switch(["restarted"], zero_period=True)

    assert set(sent) == {0.04}
    assert bench.state("owner") == "running"


@pytest.mark.parametrize("command", [0, 0j, False, -0j])
def test_what_only_equals_the_command_of_an_owner_does_not_reach_the_robot(
    bench, command
):
    owner = bench.load("owner", "j1", kind="Velocity")
    owner.actions["update"] = lambda: owner.command(0.0)
    intruder = bench.load("intruder", "j2", kind="Velocity")
    bench.switch(["owner", "intruder"])
    intruder.actions["update"] = lambda: owner.command(command)
    sent = []
    bench.robot.write = lambda *_: sent.append(bench.robot.joints.velocity_command[0])

    bench.step(3)

    assert [type(one) for one in sent] == [float] * 3
    assert bench.state("owner") == "running"


def test_a_released_joint_rests_where_it_is_in_all_its_interfaces(bench):
    bench.load("mover", "j1", kind="Velocity")
    bench.switch(["mover"])
    joints = bench.robot.joints
    joints.position[0] = 0.8  # the controller has moved it there
    bench.step()

    bench.switch(stop=["mover"])

    assert joints.position_command[0] == pytest.approx(0.8)
    assert joints.velocity_command[0] == 0.0


def test_a_failed_start_leaves_alone_what_the_request_names_and_runs_already(bench):
    bench.load("running", "j1")
    bench.load("new", "j2")
    bench.switch(["running"])
    bench.robot.script.failing = {"new"}

    result = bench.switch(["running", "new"], strictness=BEST_EFFORT)

    assert set(result.failed) == {"new"}
    assert bench.state("running") == "running"
