"""A robot that cannot be simulated is refused with file, joint and reason."""

from pathlib import Path

import pytest

from station.core.description.robot_files import RobotFiles
from station.core.description.urdf import Urdf
from station.core.errors import RobotDescriptionError
from station.hw.urdf_loader import load_urdf


def load(kind: str, inside: str) -> Urdf:
    xml = (
        f'<robot name="r"><link name="a"/><link name="b"/>'
        f'<joint name="j" type="{kind}">'
        f'<parent link="a"/><child link="b"/>{inside}</joint></robot>'
    )
    return load_urdf(RobotFiles("r", Path("r.urdf"), xml, None))


@pytest.mark.parametrize(
    ("kind", "inside", "reason"),
    [
        ("floating", "", "type 'floating', which cannot be simulated; allowed are"),
        (
            "revolute",
            '<limit lower="1" upper="0" effort="1" velocity="1"/>',
            "lower 1.0 is not below its upper 0.0",
        ),
        ("revolute", '<limit effort="1" velocity="1"/>', "lower 0.0 is not below"),
        (
            "prismatic",
            '<limit upper="1" effort="-1" velocity="1"/>',
            "effort -1.0 and velocity 1.0; they must not be negative",
        ),
        (
            "continuous",
            '<safety_controller soft_lower_limit="1" k_velocity="1"/>',
            "<safety_controller>: Joint 'j' has soft position limits from 1.0 to 0.0",
        ),
        ("revolute", "", "is revolute and has no <limit>"),
    ],
)
def test_joint_that_cannot_be_simulated_is_refused(
    kind: str, inside: str, reason: str
) -> None:
    with pytest.raises(RobotDescriptionError, match=reason) as caught:
        load(kind, inside)
    assert caught.value.message.startswith("r.urdf: ")
    assert "Joint 'j' " in caught.value.message


def test_limit_of_a_fixed_joint_does_not_matter() -> None:
    limit = '<limit lower="1" upper="0" effort="1" velocity="1"/>'
    assert load("fixed", limit).joints["j"].limit is not None


def test_missing_mesh_is_refused_with_file_link_and_uri() -> None:
    xml = (
        '<robot name="r"><link name="a"><collision><geometry><mesh filename="x.stl"/>'
        "</geometry></collision></link></robot>"
    )
    with pytest.raises(RobotDescriptionError) as caught:
        load_urdf(RobotFiles("r", Path("r.urdf"), xml, None))
    assert caught.value.message == (
        "r.urdf: Link 'a' <collision>: The mesh 'x.stl' was not found."
    )
