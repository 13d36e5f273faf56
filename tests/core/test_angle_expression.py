"""Angles are written as rosparam understands them, and nothing else runs."""

import math

import pytest

from station.core.angle_expression import parse_angle


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ("rad(pi/2)", math.pi / 2),
        ("rad(2*pi)", 2 * math.pi),
        ("deg(90)", math.pi / 2),
        ("deg(-45.5)", math.radians(-45.5)),
        ("-pi", -math.pi),
        ("rad(1 + (2 - 3) / 4)", 0.75),
    ],
)
def test_angle_is_computed(text, angle):
    assert parse_angle(text) == pytest.approx(angle, rel=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "rad()",
        "rad(1/0)",
        "deg(x)",
        "rad(True)",
        "rad(__import__('os'))",
        "rad(2**3)",
        "rad((1)",
        f"rad({'1+' * 60}1)",
    ],
)
def test_everything_else_is_refused(text):
    with pytest.raises(ValueError, match=r"arithmetic|neither|an angle may have 100"):
        parse_angle(text)
