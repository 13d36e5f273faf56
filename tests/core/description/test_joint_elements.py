"""Limits that urdfdom would discard the description for are refused with the reason."""

import pytest

from station.core.description.joint_elements import (
    read_joint_limit,
    read_joint_type,
    read_safety_controller,
)
from station.core.description.urdf import JointLimit, JointType, SafetyController
from station.core.description.urdf_text import parse_robot
from station.core.errors import RobotDescriptionError


def make_joint(kind, content):
    urdf = f'<robot><joint name="elbow" type="{kind}">{content}</joint></robot>'
    return parse_robot(urdf).find("joint")


@pytest.mark.parametrize("kind", JointType)
def test_every_type_of_joint_is_known(kind):
    assert read_joint_type(make_joint(kind.value, "")) is kind


def test_position_limits_count_for_joints_that_have_a_range():
    limit = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'
    assert read_joint_limit(make_joint("revolute", limit)) == JointLimit(-1, 2, 3, 4)
    assert read_joint_limit(make_joint("continuous", limit)) == JointLimit(
        None, None, 3, 4
    )
    assert read_joint_limit(make_joint("continuous", "")) is None


def test_soft_limits_left_out_are_zero():
    joint = make_joint("fixed", '<safety_controller k_velocity="5"/>')
    assert read_safety_controller(joint) == SafetyController(0.0, 0.0, 0.0, 5.0)
    assert read_safety_controller(make_joint("fixed", "")) is None


@pytest.mark.parametrize(
    ("kind", "content", "reason"),
    [
        ("hinge", "", "the type 'hinge'; allowed are revolute"),
        ("revolute", "", "is revolute and has no <limit>"),
        ("revolute", '<limit velocity="1"/>', "a <limit> without effort"),
        (
            "revolute",
            '<limit velocity="1x" effort="1"/>',
            'velocity="1x", not',
        ),
        ("revolute", '<limit velocity="nan" effort="1"/>', 'velocity="nan"'),
    ],
)
def test_wrong_limit_is_refused_with_joint_and_reason(kind, content, reason):
    with pytest.raises(RobotDescriptionError) as caught:
        read_joint_limit(make_joint(kind, content))
    assert "'elbow'" in caught.value.message
    assert reason in caught.value.message


def test_soft_limits_without_velocity_gain_are_refused():
    joint = make_joint("fixed", '<safety_controller k_position="1"/>')
    with pytest.raises(RobotDescriptionError, match="without k_velocity"):
        read_safety_controller(joint)
