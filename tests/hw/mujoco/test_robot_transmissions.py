"""Transmissions of a URDF, completed for simulation."""

from pathlib import Path

import pytest

from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.errors import RobotDescriptionError
from station.hw.mujoco.robot_transmissions import driven_joints, read_transmissions
from station.hw.urdf_loader import load_urdf

JOINT = '<limit lower="-1" upper="1" effort="{effort}" velocity="1"/>'
INTERFACE = "<hardwareInterface>{}</hardwareInterface>"


def describe(transmissions: str, effort: int = 5) -> RobotFiles:
    """Return a robot with the joints a, b and c; c has the given effort limit."""
    joints = "".join(
        f'<link name="link_{name}"/><joint name="{name}" type="revolute">'
        f'<parent link="{parent}"/><child link="link_{name}"/>'
        f"{JOINT.format(effort=effort if name == 'c' else 5)}</joint>"
        for name, parent in (("a", "base"), ("b", "link_a"), ("c", "link_b"))
    )
    xml = f'<robot name="r"><link name="base"/>{joints}{transmissions}</robot>'
    return RobotFiles("r", Path("/r.urdf"), xml, None)


def transmission(name: str, *joints: str, interface: str = "EffortJointInterface"):
    members = "".join(
        f'<joint name="{j}">{INTERFACE.format(interface)}</joint>' for j in joints
    )
    return (
        f'<transmission name="{name}"><type>x/Y</type>{members}'
        f'<actuator name="{name}_motor"/></transmission>'
    )


def read(description: RobotFiles):
    return read_transmissions(description, load_urdf(description))


def test_joint_without_transmission_gets_a_simple_transmission():
    infos = read(describe(transmission("t", "b")))
    assert [info.name for info in infos] == ["a_transmission", "t", "c_transmission"]
    assert infos[0].actuators[0].name == "a_motor"
    assert infos[1].type == "x/Y"


def test_every_joint_has_all_command_interfaces():
    named = "hardware_interface/VelocityJointInterface"
    infos = read(describe(transmission("t", "b", interface=named)))
    for info in infos:
        found = info.joints[0].hardware_interfaces
        assert sorted(found) == [
            "hardware_interface/EffortJointInterface",
            "hardware_interface/PositionJointInterface",
            "hardware_interface/VelocityJointInterface",
        ]
    assert infos[1].joints[0].hardware_interfaces[0] == named


def test_joint_without_effort_is_not_driven(caplog):
    description = describe(transmission("t", "c"), effort=0)
    assert driven_joints(load_urdf(description)) == ["a", "b"]
    assert [info.name for info in read(description)] == [
        "a_transmission",
        "b_transmission",
    ]
    assert "t is left out" in caplog.text


@pytest.mark.parametrize(
    ("xml", "effort", "parts"),
    [
        (transmission("t", "a", "c"), 0, ["'c'", "cannot move"]),
        (transmission("t", "a", "d"), 5, ["'d'", "is missing"]),
        (transmission("t", "a") + transmission("u", "a"), 5, ["joint 'a'", "in use"]),
        (transmission("t", "a") + transmission("t", "b"), 5, ["'t'", "in use"]),
    ],
)
def test_contradictions_are_refused(xml, effort, parts):
    with pytest.raises(RobotDescriptionError) as caught:
        read(describe(xml, effort))
    for part in ["/r.urdf", "<transmission name=", *parts]:
        assert part in caught.value.message


def test_part_of_a_robot_loads_without_the_rest(caplog):
    description = load_robot_files("example-robot-data:talos_left_arm")
    infos = read_transmissions(description, load_urdf(description))
    assert "arm_left_1_trans is left out" in caplog.text
    wrist = next(info for info in infos if info.name == "wrist_left_trans")
    assert [j.name for j in wrist.joints] == ["arm_left_6_joint", "arm_left_7_joint"]
