"""The elements of ros2_control are read as its parser reads them, or refused."""

from xml.etree import ElementTree as ET

import pytest

from station.core.description.ros2_control import InterfaceTag, read_ros2_control
from station.core.errors import RobotDescriptionError

JOINTS = """
  <joint name="a" type="revolute"><limit lower="-1" upper="1" effort="5" velocity="2"/>
  </joint>
  <joint name="b" type="revolute"><limit lower="-1" upper="1" effort="5" velocity="2"/>
    <mimic joint="a"/></joint>
  <joint name="f" type="fixed"/>
"""
HARDWARE = (
    "<hardware><plugin>my/Plugin</plugin><param name='ip'> 1.2 </param></hardware>"
)


def read(body, *, kind="system", name="arm"):
    text = f'<ros2_control name="{name}" type="{kind}">{body}</ros2_control>'
    return read_ros2_control(ET.fromstring(f"<robot>{JOINTS}{text}</robot>"))


def test_a_component_is_read_with_all_its_parts():
    (found,) = read(f"""{HARDWARE}<properties><async thread_priority="3"/></properties>
        <joint name="a"><command_interface name="position">
            <param name="min">-0.5</param><param name="max">0.5</param>
          </command_interface>
          <command_interface name="velocity"><limits enable="false"/>
          </command_interface>
          <state_interface name="position"><param name="initial_value">0.2</param>
          </state_interface></joint>
        <joint name="b"><state_interface name="position"/></joint>
        <sensor name="ft"><param name="frame_id">tool</param>
          <state_interface name="force.x"/></sensor>
        <gpio name="io"><command_interface name="out" data_type="bool">
          <param name="initial_value">true</param></command_interface></gpio>
        <transmission name="t"/>""")
    assert (found.name, found.type, found.plugin) == ("arm", "system", "my/Plugin")
    assert found.parameters == {"ip": "1.2"}
    assert found.joints[0].commands == (
        InterfaceTag("position", -0.5, 0.5),
        InterfaceTag("velocity", is_limited=False),
    )
    assert found.joints[0].initial_value("position") == 0.2
    assert found.sensors[0].parameters == {"frame_id": "tool"}
    assert found.gpios[0].commands == (
        InterfaceTag("out", initial_value=1.0, data_type="bool"),
    )
    assert len(found.transmissions) == 1


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("", "no <hardware> with a <plugin>"),
        (f"{HARDWARE}<joint name='zz'/>", "'zz', which the URDF has not"),
        (f"{HARDWARE}<joint name='f'/>", "'f', which is fixed"),
        (f"{HARDWARE}<joint name='a' mimic='true'/>", "'a' mimics; the URDF does not"),
        (
            f"{HARDWARE}<joint name='a'/><joint name='b'>"
            "<command_interface name='position'/></joint>",
            "'b', which mimics another one",
        ),
        (f"{HARDWARE}<joint name='b'/>", "lacks the joint 'a', which 'b' mimics"),
        (f"{HARDWARE}<xacro/>", "unknown element <xacro>"),
        (f"{HARDWARE}<joint/>", "<joint> without the attribute 'name'"),
        (
            f"{HARDWARE}<gpio name='g'><state_interface name='s' size='3'/></gpio>",
            "g/s as an array",
        ),
        (
            f"{HARDWARE}<gpio name='g'><state_interface name='s' data_type='text'/>"
            "</gpio>",
            "unknown data type 'text'",
        ),
        (
            f"{HARDWARE}<joint name='a'><command_interface name='position'>"
            "<param name='min'>${low}</param></command_interface></joint>",
            "min of a/position as '${low}'",
        ),
        (
            f"{HARDWARE}<joint name='a'><command_interface name='position'>"
            "<param name='min'>2</param><param name='max'>1</param>"
            "</command_interface></joint>",
            "min 2 of a/position above max 1",
        ),
    ],
)
def test_what_is_wrong_is_refused_by_the_component_and_the_element(body, words):
    with pytest.raises(RobotDescriptionError, match='name="arm"') as caught:
        read(body)
    assert words in caught.value.message


def test_a_type_that_is_no_component_and_a_name_that_is_twice_are_refused():
    with pytest.raises(RobotDescriptionError, match="system, actuator, sensor"):
        read(HARDWARE, kind="arm")
    twice = f'<ros2_control name="x" type="system">{HARDWARE}</ros2_control>' * 2
    with pytest.raises(RobotDescriptionError, match="is there twice"):
        read_ros2_control(ET.fromstring(f"<robot>{twice}</robot>"))


def test_a_mimic_joint_that_is_switched_off_may_be_commanded():
    (found,) = read(
        f"{HARDWARE}<joint name='b' mimic='false'>"
        "<command_interface name='position'/></joint>"
    )
    assert found.joints[0].is_mimic is False


def tagged(attributes, body=""):
    text = f'<ros2_control name="arm" type="system" {attributes}>{HARDWARE}{body}'
    (found,) = read_ros2_control(ET.fromstring(f"<robot>{text}</ros2_control></robot>"))
    return found.timing


def test_what_says_how_often_it_is_read_and_written_is_kept_by_name():
    assert tagged('is_async="false" rw_rate="0"') == {}
    more = '<properties><async thread_priority="30" affinity="[2]"/></properties>'
    assert tagged('is_async="true" rw_rate="100" thread_priority="5"', more) == {
        "is_async": "true",
        "rw_rate": "100",
        "thread_priority": "5",
        "async thread_priority": "30",
        "async affinity": "[2]",
    }


@pytest.mark.parametrize(
    ("attributes", "words"),
    [
        ('is_async="perhaps"', "'perhaps' for is_async"),
        ('rw_rate="fast"', "'fast' for rw_rate"),
        ('rw_rate="-1"', "'-1' for rw_rate"),
        ('asnyc="true"', "unknown attribute 'asnyc'"),
    ],
)
def test_attributes_that_are_wrong_are_refused_by_their_name(attributes, words):
    with pytest.raises(RobotDescriptionError, match=words):
        tagged(attributes)
