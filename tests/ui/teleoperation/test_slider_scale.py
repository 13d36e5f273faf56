"""Ranges and steps of sliders."""

import pytest

from station.ui.teleoperation.viser_panel import SliderScale, command_scale, gain_scale


def test_a_command_slider_stays_inside_the_limits():
    scale = command_scale("rad", -2.8973, 2.8973)
    assert (scale.minimum, scale.maximum) == (-2.897, 2.897)


def test_an_unlimited_command_gets_a_modest_range():
    scale = command_scale("Nm", None, None)
    assert (scale.minimum, scale.maximum) == (-10.0, 10.0)


def test_an_empty_range_is_still_a_slider():
    scale = command_scale("rad", 1.0, 1.0)
    assert scale.maximum > scale.minimum


@pytest.mark.parametrize(
    ("value", "minimum", "maximum", "ends"),
    [
        (600.0, 0.0, 1e6, (0.0, 2000.0)),
        (0.0, 0.0, 1e6, (0.0, 100.0)),
        (30.0, 0.0, 40.0, (0.0, 40.0)),
        (-5.0, -1e3, 0.0, (-10.0, 0.0)),
        (-5.0, None, None, (-10.0, 10.0)),
        (0.0, 0.0, 0.0, (0.0, 1.0)),
    ],
)
def test_a_gain_slider_ends_at_a_round_number_within_the_limits(
    value, minimum, maximum, ends
):
    scale = gain_scale(value, minimum, maximum)
    assert (scale.minimum, scale.maximum) == ends
    assert 0.0 < scale.step <= (ends[1] - ends[0]) / 100.0


def test_values_beyond_the_ends_are_shown_at_the_ends():
    scale = SliderScale(0.0, 1.0, 0.1)
    assert [scale.clamp(v) for v in (-1.0, 0.5, 2.0)] == [0.0, 0.5, 1.0]
