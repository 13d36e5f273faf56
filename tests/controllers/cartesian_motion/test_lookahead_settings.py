"""What is kept free of joint limits can be set within what the arms allow."""

import pytest

from station.controllers.cartesian_motion.joint_lookahead import (
    LARGEST_JOINT_ACCELERATION,
    LookaheadSettings,
    read_lookahead_settings,
)
from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS


def read(**values):
    return read_lookahead_settings(Parameters(ParameterTree({"it": values}), "it"))


def test_without_parameters_the_defaults_hold():
    assert read() == LookaheadSettings()


def test_no_acceleration_is_beyond_what_an_arm_allows():
    for arm in (PANDA_LIMITS, FR3_LIMITS):
        pairs = zip(LARGEST_JOINT_ACCELERATION, arm.acceleration, strict=True)
        assert all(value <= allowed for value, allowed in pairs)


def test_one_acceleration_counts_for_all_joints():
    assert read(max_joint_acceleration=3.0).max_joint_acceleration == (3.0,) * 7
    seven = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
    assert read(max_joint_acceleration=seven).max_joint_acceleration == tuple(seven)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("joint_limit_margin", -0.1),
        ("least_dexterity", 0.0),
        ("least_clearance", -0.01),
        ("joint_velocity_share", 1.1),
        ("max_joint_acceleration", 8.0),
        ("max_joint_acceleration", [1.0]),
        ("max_joint_acceleration", 0.0),
    ],
)
def test_what_is_out_of_range_is_refused_by_name(key, value):
    with pytest.raises(ParameterError, match=f"it/{key}"):
        read(**{key: value})
