"""What a URDF says about wheels."""

import pytest

from station.core.description.urdf import wheel_radius, wheel_separation
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import RobotDescriptionError

WHEEL = """<link name="{0}_link"><collision><geometry>{2}</geometry></collision></link>
<joint name="{0}" type="continuous"><parent link="base"/><child link="{0}_link"/>
<origin xyz="0 {1} 0.1"/></joint>"""
PARTS = (
    WHEEL.format("left", 0.3, '<sphere radius="0.15"/>'),
    WHEEL.format("right", -0.1, '<box size="1 1 1"/>'),
)
URDF = parse_urdf(f'<robot name="r"><link name="base"/>{"".join(PARTS)}</robot>')


def test_size_is_read() -> None:
    assert wheel_separation(URDF, "left", "right") == pytest.approx(0.4)
    assert wheel_radius(URDF, "left") == 0.15


def test_what_is_not_there_is_refused() -> None:
    with pytest.raises(RobotDescriptionError, match="cylinder or a sphere"):
        wheel_radius(URDF, "right")
    with pytest.raises(RobotDescriptionError, match="no joint 'ghost'"):
        wheel_separation(URDF, "left", "ghost")
    with pytest.raises(RobotDescriptionError, match="the same origin"):
        wheel_separation(URDF, "left", "left")
