"""Pairs of links that an SRDF excludes from collision."""

from pathlib import Path

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.description.srdf import disabled_collisions
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
