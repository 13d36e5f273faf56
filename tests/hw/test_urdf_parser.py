"""What a URDF says, and that every mistake in it is named."""

from math import pi
from pathlib import Path

import pytest

from station.core.errors import RobotDescriptionError
from station.hw.robot_description import RobotDescription, load_robot_description
from station.hw.urdf import JointType, Urdf
from station.hw.urdf_parser import parse_urdf

LINKS = '<link name="a"/><link name="b"/>'


def parse(body: str) -> Urdf:
    xml = f'<robot name="r">{body}</robot>'
    return parse_urdf(RobotDescription("r", Path("r.urdf"), xml, None))


def hinge(inside: str = "", attributes: str = 'name="j" type="revolute"') -> str:
    limit = "" if "<limit" in inside else '<limit effort="1" velocity="2" upper="1"/>'
    return (
        f'{LINKS}<joint {attributes}><parent link="a"/><child link="b"/>'
        f"{limit}{inside}</joint>"
    )


def test_panda_has_its_joints_limits_and_mimic() -> None:
    urdf = parse_urdf(load_robot_description("example-robot-data:panda"))
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


def test_prefix_is_replaced_in_every_name() -> None:
    description = load_robot_description("example-robot-data:panda")
    left = parse_urdf(description.with_prefix("panda_", "left_"))
    assert left.root == "left_link0"
    assert not [n for n in (*left.links, *left.joints) if not n.startswith("left_")]
    mimic = left.joints["left_finger_joint2"].mimic
    assert mimic is not None
    assert mimic.joint == "left_finger_joint1"


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
        (LINKS + '<link name="a"/>', "link 'a': is defined twice"),
        (hinge().replace(LINKS, '<link name="a"/>'), "names the link 'b'"),
        (hinge("<limit/>"), "Joint 'j' has a <limit> without effort"),
        (
            hinge('<limit lower="1" upper="0" effort="1" velocity="1"/>'),
            "joint 'j' <limit>: lower 1.0 is not below upper 0.0",
        ),
        (
            hinge('<limit upper="1" effort="nan" velocity="1"/>'),
            "Joint 'j' has a <limit> with effort=",
        ),
        (hinge('<limit upper="1" effort="-1" velocity="1"/>'), "not be negative"),
        (hinge(attributes='name="j" type="floating"'), "type 'floating'; use one"),
        (hinge('<axis xyz="0 0 0"/>'), "has the axis 0 0 0"),
        (hinge('<axis xyz="0 1"/>'), "xyz is '0 1'; needs 3 finite"),
        (hinge('<mimic joint="k"/>'), "mimics 'k', which is no independent joint"),
        (hinge('<dynamics damping="-1"/>'), "damping is -1.0; must be >= 0"),
        (
            f'{LINKS}<joint name="j" type="revolute"><parent link="a"/>'
            '<child link="b"/></joint>',
            "Joint 'j' is revolute and has no <limit>",
        ),
        ('<link name="a"><collision/></link>', "link 'a' <collision>: has no <geom"),
        (
            '<link name="a"><collision><geometry><cone/></geometry></collision></link>',
            "unknown geometry <cone>",
        ),
        (
            '<link name="a"><collision><geometry><mesh filename="x.stl"/></geometry>'
            "</collision></link>",
            "the mesh 'x.stl' was not found",
        ),
        (
            '<link name="a"><inertial><mass value="-1"/></inertial></link>',
            "link 'a' <inertial>: mass is -1.0",
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
    with pytest.raises(RobotDescriptionError, match="link 'a': is part of a loop"):
        parse(loop)


def test_links_in_an_endless_row_are_refused(tmp_path):
    joints = "".join(
        f'<link name="l{i + 1}"/><joint name="j{i}" type="fixed">'
        f'<parent link="l{i}"/><child link="l{i + 1}"/></joint>'
        for i in range(300)
    )
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="r"><link name="l0"/>{joints}</robot>')
    with pytest.raises(RobotDescriptionError, match="more than 255 joints in a row"):
        parse_urdf(load_robot_description(str(path)))
