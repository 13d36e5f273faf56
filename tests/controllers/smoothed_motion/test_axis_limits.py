"""Limits from the parameters or the robot description, and what is refused."""

from math import inf, nan

import pytest

from station.controllers.smoothed_motion.axis_limits import read_axis_limits
from station.core.description.robot_description import JointDescription
from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree

JOINTS = [JointDescription("a", velocity=2.0), JointDescription("b", velocity=1.0)]


def read(joints=JOINTS, **values):
    return read_axis_limits(Parameters(ParameterTree({"arm": values}), "arm"), joints)


def test_without_parameters_they_follow_from_the_description():
    limits = read()

    assert limits.velocity == (2.0, 1.0)
    assert limits.acceleration == (4.0, 2.0)
    assert limits.jerk == (40.0, 20.0)


def test_one_number_or_one_for_each():
    limits = read(max_velocity=0.5, max_acceleration=[3, 4.0], max_jerk=50)

    assert limits.velocity == (0.5, 0.5)
    assert limits.acceleration == (3.0, 4.0)
    assert limits.jerk == (50.0, 50.0)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"max_velocity": 1.5}, "<= 1.0"),
        ({"max_velocity": 0.0}, "> 0"),
        ({"max_velocity": [1.0]}, "2 numbers"),
        ({"max_velocity": "fast"}, "max_velocity"),
        ({"max_acceleration": -1.0}, "> 0"),
        ({"max_acceleration": inf}, "finite"),
        ({"max_jerk": [nan, 1.0]}, "finite"),
    ],
)
def test_impossible_limits_are_refused(values, message):
    with pytest.raises(ParameterError, match=message):
        read(**values)


def test_a_joint_without_a_limit_needs_the_parameter():
    with pytest.raises(ParameterError, match="missing"):
        read([JointDescription("wheel")])
    assert read([JointDescription("wheel")], max_velocity=1.0).velocity == (1.0,)
