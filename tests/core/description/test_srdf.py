"""Pairs of links that an SRDF excludes from collision."""

from pathlib import Path

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.description.srdf import disabled_collisions, group_states
from station.core.errors import RobotDescriptionError


def test_pairs_of_the_panda_are_read() -> None:
    description = load_robot_files("example-robot-data:panda")
    pairs = disabled_collisions(description.srdf_path)
    assert ("panda_link5", "panda_link7") in pairs


def test_robot_without_srdf_has_no_pairs() -> None:
    assert disabled_collisions(None) == ()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("<robot", "SRDF .* cannot be read: The robot description is not XML"),
        ('<robot><disable_collisions link1="a"/></robot>', "link1 and link2"),
    ],
)
def test_broken_srdf_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    path = tmp_path / "r.srdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RobotDescriptionError, match=reason):
        disabled_collisions(path)


def test_poses_of_the_panda_are_read() -> None:
    description = load_robot_files("example-robot-data:panda")
    states = group_states(description.srdf_path)
    assert states["default"]["panda_joint4"] == -2.35619


def test_a_robot_without_srdf_has_no_poses() -> None:
    assert group_states(None) == {}


@pytest.mark.parametrize("value", ["x", "", "nan", "inf"])
def test_a_pose_that_is_no_number_is_refused(tmp_path: Path, value: str) -> None:
    path = tmp_path / "r.srdf"
    state = f'<group_state name="up"><joint name="j" value="{value}"/></group_state>'
    path.write_text(f"<robot>{state}</robot>")
    with pytest.raises(RobotDescriptionError, match="'j' of a <group_state>"):
        group_states(path)
