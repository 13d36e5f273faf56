"""Commands that follow from desired and measured values alone."""

from station.controllers.set_point_controller import DirectLaw
from station.core.numerics.joint_errors import JointErrors
from station.memory.doubles import doubles, zeros


def test_desired_values_are_commanded():
    commands = zeros(2)
    DirectLaw(doubles([1.0, 2.0]), commands).compute_commands(0.001)
    assert [*commands] == [1.0, 2.0]


def test_desired_values_are_commanded_and_compared():
    desired, commands, errors = doubles([1.0, 2.0]), zeros(2), zeros(2)
    comparison = JointErrors(desired, doubles([0.5, 3.0]), errors)
    DirectLaw(desired, commands, comparison).compute_commands(0.001)
    assert [*commands] == [1.0, 2.0]
    assert [*errors] == [0.5, -1.0]
