"""Conflicts between controllers, and what a robot does that overrides nothing."""

import pytest

from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    RobotHW,
    SwitchState,
)
from station.core.parameters import Parameters


def info(name, *claims):
    return ControllerInfo(
        name,
        "test/Type",
        tuple(InterfaceResources(interface, tuple(r)) for interface, *r in claims),
    )


ONE = info("one", ("Effort", "a", "b"))
OTHER = info("other", ("Effort", "c"))
OVERLAP = info("overlap", ("Position", "b", "d"))
TWICE = info("twice", ("Effort", "a"), ("Position", "a"))
BOTH = info("both", ("Effort", "a"), ("Position", "b"))
STATE = info("state", ("State",))


@pytest.mark.parametrize(
    ("controllers", "resources"),
    [
        ([], []),
        ([ONE], []),
        ([ONE, OTHER], []),
        ([BOTH], []),
        ([ONE, OVERLAP], ["b"]),
        ([TWICE], ["a"]),
        ([ONE, BOTH], ["a", "b"]),
        ([STATE, STATE], []),
    ],
)
def test_a_resource_has_at_most_one_claim(controllers, resources):
    conflicts = RobotHW().check_for_conflict(controllers)

    assert [conflict.resource for conflict in conflicts] == resources


def test_a_conflict_says_who_claims_what_through_which_interface():
    (conflict,) = RobotHW().check_for_conflict([ONE, OVERLAP])

    assert conflict.holders == (("one", "Effort"), ("overlap", "Position"))
    assert conflict.reason == (
        "Resource 'b' is claimed by 'one' (Effort) and 'overlap' (Position)."
    )


def test_a_robot_that_overrides_nothing_agrees_to_everything():
    robot = RobotHW()

    robot.init(Parameters(), Parameters())
    robot.read(0.0, 0.0)
    robot.write(0.0, 0.0)
    robot.prepare_switch([ONE], [])
    robot.do_switch([ONE], [])

    assert robot.switch_result() is SwitchState.DONE
    assert robot.switch_result_for(ONE) is SwitchState.DONE
    assert robot.mode() == "running"
