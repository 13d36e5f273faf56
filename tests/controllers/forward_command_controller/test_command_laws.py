"""Commands that follow from desired and measured values alone."""

import pytest

from station.controllers.forward_command_controller.command_laws import (
    ComparingLaw,
    DirectLaw,
    PidLaw,
)
from station.core.numerics.joint_errors import JointErrors
from station.core.numerics.pid_group import PidGroup
from station.memory.doubles import doubles, zeros


def test_desired_values_are_commanded():
    commands = zeros(2)
    DirectLaw(doubles([1.0, 2.0]), commands).command(0.001)
    assert [*commands] == [1.0, 2.0]


def test_desired_values_are_commanded_and_compared():
    desired, commands, errors = doubles([1.0, 2.0]), zeros(2), zeros(2)
    comparison = JointErrors(desired, doubles([0.5, 3.0]), errors)
    ComparingLaw(desired, commands, comparison).command(0.001)
    assert [*commands] == [1.0, 2.0]
    assert [*errors] == [0.5, -1.0]


@pytest.mark.parametrize(("share", "command"), [(0.0, 6.0), (0.5, 7.0)])
def test_a_share_of_the_desired_rate_is_added_to_the_pid(share, command):
    commands = zeros(1)
    pids = PidGroup(doubles([3.0]), doubles([0.0]), commands)
    pids.set_gains(0, 2.0, 0.0, 0.0, 0.0, 0.0)
    PidLaw(pids, doubles([2.0]), doubles([share])).command(0.001)
    assert [*commands] == [command]
