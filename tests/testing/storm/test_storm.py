"""Storms over the robots of the station find nothing, and find what is planted."""

import re
import threading

import pytest

from station.core.control.controller_lifecycle import ControllerLifecycle
from station.core.control.pending_switch import PendingSwitch
from station.core.hardware.robot_hw import RobotHW
from station.testing.storm import storm
from station.testing.storm.__main__ import ROBOTS, main
from station.testing.storm.storm_worker import find_claims


def rage(name, operations, **options):
    robot = ROBOTS[name]
    return storm(
        robot.create,
        operations=operations,
        faults=robot.faults,
        drift=robot.drift,
        **options,
    )


@pytest.mark.parametrize("name", ROBOTS)
def test_a_short_storm_finds_nothing(name):
    report = rage(name, 400, seed=7)

    assert report.problems == ()
    assert report.operations.total() == 400
    assert report.switches["committed"] > 0
    assert "nothing was wrong" in str(report)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "operations"),
    [("mock", 100_000), ("combined", 5_000), ("franka", 5_000)],
)
def test_a_long_storm_finds_nothing(name, operations):
    # What is planted below is found within 3,000 operations.
    report = rage(name, operations)

    assert report.problems == ()
    assert report.operations.total() == operations
    assert report.mischiefs > operations / 50
    assert report.switches["committed"] > operations / 20


@pytest.mark.long
@pytest.mark.usefixtures("open_gate")
def test_commands_that_nobody_puts_back_are_found():
    report = rage("mock", 1000)

    assert not report.ok
    assert re.search("without an owner", str(report))


@pytest.mark.long
def test_a_robot_that_is_not_told_is_found(monkeypatch):
    monkeypatch.setattr(ControllerLifecycle, "release", lambda *_: None)

    report = rage("mock", 2000)

    assert re.search("was not told what became of", str(report))


@pytest.mark.long
def test_an_answer_that_is_not_true_is_found(monkeypatch):
    monkeypatch.setattr(PendingSwitch, "note_start", lambda *_: None)

    report = rage("mock", 3000)

    assert re.search("is not true: said to be", str(report))


@pytest.mark.long
def test_a_loop_that_dies_is_found():
    class Fragile(type(ROBOTS["mock"].create())):
        def write(self, time, period):
            if time > 0.05:
                raise RuntimeError("no bus")

    def create():
        robot = ROBOTS["mock"].create()
        robot.__class__ = Fragile
        return robot

    report = storm(create, operations=2000)

    assert "the loop died: RuntimeError: no bus" in str(report)


@pytest.mark.long
def test_an_operation_that_hangs_is_found():
    never = threading.Event()

    def hang(start, _):
        if [info.name for info in start] != ["storm"]:  # when it is asked for claims
            never.wait(1.0)

    def create():
        robot = ROBOTS["mock"].create()
        robot.prepare_switch = hang
        return robot

    report = storm(create, operations=200, deadline=0.5)

    assert "takes longer than 0.5 s" in str(report)


def test_a_robot_without_commands_is_refused():
    with pytest.raises(ValueError, match="accepts no claim"):
        storm(RobotHW, operations=1)


def test_a_franka_accepts_its_joints_together_only():
    claims = find_claims(ROBOTS["franka"].create())

    sizes = {len(c.resources) for c in claims if "panda_joint1" in c.resources}
    assert sizes == {7, 9}  # without and with the fingers
    assert {c.interface.partition("::")[0] for c in claims} == {
        "hardware_interface",
        "franka_hw",
    }


def test_the_command_line_prints_the_report(capsys):
    assert main(["--operations", "40", "--seed", "3"]) == 0

    assert "40 operations by 4 threads, seed 3" in capsys.readouterr().out
