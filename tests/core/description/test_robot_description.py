"""What is read of a URDF, and what is refused."""

from math import inf

import pytest

from station.core.description.robot_description import (
    JointDescription,
    RobotDescription,
    find_robot_description,
    require_robot_description,
)
from station.core.description.urdf import JointType
from station.core.errors import RobotDescriptionError
from station.core.parameters import Parameters, ParameterTree

SLIDE = "type='prismatic'"


def _joint(attributes, limit=""):
    return RobotDescription(
        f"<robot name='r'><joint name='j' {attributes}>{limit}</joint></robot>"
    ).joint("j")


def test_a_revolute_joint_has_its_limits():
    joint = _joint(
        "type='revolute'", "<limit lower='-1' upper='2' velocity='3' effort='4'/>"
    )
    assert joint == JointDescription("j", JointType.REVOLUTE, -1.0, 2.0, 3.0, 4.0)
    assert joint.type.has_position_limits
    assert not joint.is_linear()


def test_a_continuous_joint_has_no_position_limits():
    joint = _joint(
        "type='continuous'", "<limit lower='-1' upper='1' velocity='3' effort='0'/>"
    )
    assert (joint.lower, joint.upper) == (-inf, inf)
    assert (joint.velocity, joint.effort) == (3.0, inf)
    assert not joint.type.has_position_limits


@pytest.mark.parametrize(
    ("attributes", "limit", "message"),
    [
        ("type='revolute'", "", "has no <limit>"),
        ("type='wobbly'", "", "has the type 'wobbly'"),
        ("type='prismatic'", "<limit lower='0' upper='1'/>", "without effort"),
        (SLIDE, "<limit lower='1' upper='0' effort='1' velocity='1'/>", "from 1.0 to"),
        (SLIDE, "<limit lower='x' upper='0' effort='1' velocity='1'/>", 'lower="x"'),
        (SLIDE, "<limit upper='inf' effort='1' velocity='1'/>", 'upper="inf"'),
        (SLIDE, "<limit effort='1' velocity='-1'/>", "velocity limit of -1.0"),
    ],
)
def test_an_impossible_joint_is_refused(attributes, limit, message):
    with pytest.raises(RobotDescriptionError, match=message):
        _joint(attributes, limit)


@pytest.mark.parametrize("xml", ["panda.urdf", "<sdf/>", ""])
def test_what_is_no_urdf_is_refused(xml):
    with pytest.raises(RobotDescriptionError):
        RobotDescription(xml)


def test_an_unknown_joint_is_refused_with_the_names_of_all():
    description = RobotDescription("<robot><joint name='a' type='fixed'/></robot>")
    with pytest.raises(RobotDescriptionError) as caught:
        description.joint("b")
    assert caught.value.remedy == "It has: a."


def test_the_nearest_description_is_found():
    tree = ParameterTree({
        "robot_description": "<robot><joint name='outer' type='fixed'/></robot>",
        "left": {
            "robot_description": "<robot><joint name='inner' type='fixed'/></robot>"
        },
    })
    inner = find_robot_description(Parameters(tree, "left/arm"))
    outer = find_robot_description(Parameters(tree, "right/arm"))
    assert inner is not None
    assert outer is not None
    assert inner.joint_names() == ["inner"]
    assert outer.joint_names() == ["outer"]


def test_controllers_of_one_robot_share_what_was_read():
    tree = ParameterTree({"robot_description": "<robot name='r'/>", "c": {}, "d": {}})
    first, second = (find_robot_description(Parameters(tree, name)) for name in "cd")
    assert first is second


def test_a_missing_description_is_none_or_an_error():
    params = Parameters(ParameterTree(), "arm")
    assert find_robot_description(params) is None
    with pytest.raises(RobotDescriptionError, match="'robot_description' is missing"):
        require_robot_description(params)


def test_soft_limits_are_those_of_the_safety_controller():
    safety = (
        "<safety_controller k_velocity='1' soft_lower_limit='-1' soft_upper_limit='2'/>"
    )
    description = RobotDescription(
        f"<robot><joint name='a' type='fixed'>{safety}</joint>"
        "<joint name='b' type='fixed'/></robot>"
    )
    assert description.soft_limits("a") == (-1.0, 2.0)
    with pytest.raises(RobotDescriptionError, match="'b' has no <safety_controller>"):
        description.soft_limits("b")
