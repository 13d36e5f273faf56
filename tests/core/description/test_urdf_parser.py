"""What a URDF says, and that every mistake in it is named.

Limits that urdfdom would discard the description for are refused with the reason.
"""

from math import pi
from pathlib import Path

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.description.urdf import JointLimit, JointType, SafetyController, Urdf
from station.core.description.urdf_parser import (
    parse_urdf,
    read_joint_limit,
    read_joint_type,
    read_safety_controller,
)
from station.core.description.urdf_text import parse_robot
from station.core.errors import RobotDescriptionError

LINKS = '<link name="a"/><link name="b"/>'


def parse(body: str) -> Urdf:
    return parse_urdf(f'<robot name="r">{body}</robot>', source="r.urdf")


def hinge(inside: str = "", attributes: str = 'name="j" type="revolute"') -> str:
    limit = "" if "<limit" in inside else '<limit effort="1" velocity="2" upper="1"/>'
    return (
        f'{LINKS}<joint {attributes}><parent link="a"/><child link="b"/>'
        f"{limit}{inside}</joint>"
    )


def test_panda_has_its_joints_limits_and_mimic() -> None:
    urdf = parse_urdf(load_robot_files("example-robot-data:panda").xml)
    joint4 = urdf.joints["panda_joint4"]
    assert urdf.root == "panda_link0"
    assert joint4.type is JointType.REVOLUTE
    assert joint4.limit is not None
    assert (joint4.limit.lower, joint4.limit.upper) == (-3.0718, -0.0698)
    assert (joint4.limit.velocity, joint4.limit.effort) == (2.175, 87.0)
    assert joint4.damping == 0.003
    mimic = urdf.joints["panda_finger_joint2"].mimic
    assert mimic is not None
    assert (mimic.joint, mimic.multiplier, mimic.offset) == (
        "panda_finger_joint1",
        1.0,
        0.0,
    )
    assert urdf.links["panda_link8"].is_frame_only


def test_defaults_of_the_format_are_applied() -> None:
    joint = parse(hinge()).joints["j"]
    assert joint.axis == (1.0, 0.0, 0.0)
    assert joint.limit is not None
    assert joint.limit.lower == 0.0
    assert joint.origin.quaternion == (1.0, 0.0, 0.0, 0.0)


def test_rpy_turns_about_fixed_axes_x_then_y_then_z() -> None:
    origin = f'<origin rpy="{pi / 2} 0 {pi / 2}"/>'
    pose = parse(hinge(origin)).joints["j"].origin
    # x: (0, 1, 0) -> (0, 0, 1), which z leaves; z: (1, 0, 0) -> (0, 1, 0).
    assert pose.quaternion == pytest.approx((0.5, 0.5, 0.5, 0.5))


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("", "needs exactly one root link, but has none"),
        (LINKS, "one root link, but has .'a', 'b'."),
        (LINKS + '<link name="a"/>', "Link 'a' is defined twice"),
        (hinge().replace(LINKS, '<link name="a"/>'), "names the link 'b', which"),
        (hinge("<limit/>"), "Joint 'j' has a <limit> without effort"),
        (
            hinge('<limit upper="1" effort="nan" velocity="1"/>'),
            "Joint 'j' has a <limit> with effort=",
        ),
        (hinge('<axis xyz="0 0 0"/>'), "has the axis 0 0 0"),
        (hinge('<axis xyz="0 1"/>'), 'xyz="0 1"; 3 finite'),
        (hinge('<mimic joint="k"/>'), "mimics 'k', which is no independent joint"),
        (hinge('<dynamics damping="-1"/>'), "damping -1.0; it must be >= 0"),
        (
            f'{LINKS}<joint name="j" type="revolute"><parent link="a"/>'
            '<child link="b"/></joint>',
            "Joint 'j' is revolute and has no <limit>",
        ),
        ('<link name="a"><collision/></link>', "Link 'a' <collision> has no <geom"),
        (
            '<link name="a"><collision><geometry><cone/></geometry></collision></link>',
            "unknown geometry <cone>",
        ),
        (
            '<link name="a"><collision><geometry><sphere radius="0"/></geometry>'
            "</collision></link>",
            "all lengths must be positive",
        ),
        (
            '<link name="a"><collision><geometry><!-- none --></geometry></collision>'
            "</link>",
            "has an empty <geometry>",
        ),
        (hinge(attributes='name="j" type="wobbly"'), "the type 'wobbly'; allowed are"),
        (
            '<link name="a"><inertial><mass value="-1"/></inertial></link>',
            "Link 'a' <inertial> has a mass of -1.0",
        ),
    ],
)
def test_mistake_is_refused_with_file_element_and_reason(
    body: str, reason: str
) -> None:
    with pytest.raises(RobotDescriptionError, match=reason) as caught:
        parse(body)
    assert str(caught.value).startswith("r.urdf: ")


def test_loop_of_joints_is_refused() -> None:
    loop = (
        '<link name="r"/><link name="a"/><link name="b"/>'
        '<joint name="i" type="fixed"><parent link="a"/><child link="b"/></joint>'
        '<joint name="j" type="fixed"><parent link="b"/><child link="a"/></joint>'
    )
    with pytest.raises(RobotDescriptionError, match="Link 'a' is part of a loop"):
        parse(loop)


def test_links_in_an_endless_row_are_refused() -> None:
    joints = "".join(
        f'<link name="l{i + 1}"/><joint name="j{i}" type="fixed">'
        f'<parent link="l{i}"/><child link="l{i + 1}"/></joint>'
        for i in range(300)
    )
    with pytest.raises(RobotDescriptionError, match="more than 255 joints in a row"):
        parse(f'<link name="l0"/>{joints}')


MESH = (
    '<link name="a"><collision><geometry><!-- the hull --><mesh filename="x.stl"/>'
    "</geometry></collision></link>"
)


def test_mesh_file_is_that_which_the_finder_returns() -> None:
    found = parse_urdf(
        f"<robot>{MESH}</robot>", find_mesh=lambda uri: Path("/meshes") / uri
    )
    assert found.links["a"].collisions[0].mesh == Path("/meshes/x.stl")
    assert parse(MESH).links["a"].collisions[0].mesh == Path("x.stl")


def test_missing_mesh_is_refused_with_its_link() -> None:
    def find(uri: str) -> Path:
        raise RobotDescriptionError(f"The mesh '{uri}' was not found.")

    with pytest.raises(RobotDescriptionError) as caught:
        parse_urdf(f"<robot>{MESH}</robot>", find_mesh=find)
    assert caught.value.message == (
        "Link 'a' <collision>: The mesh 'x.stl' was not found."
    )


@pytest.mark.parametrize("text", ["<sdf/>", "<robot", ""])
def test_document_that_is_no_urdf_is_refused_with_its_source(text: str) -> None:
    with pytest.raises(RobotDescriptionError, match=r"^r\.urdf: The robot description"):
        parse_urdf(text, source="r.urdf")


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_joint_that_moves_freely_is_read(kind: str) -> None:
    joint = parse(hinge(attributes=f'name="j" type="{kind}"')).joints["j"]
    assert joint.type is JointType(kind)
    assert joint.limit is not None
    assert joint.limit.lower is None


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
