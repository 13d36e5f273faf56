"""A configuration error names every problem at once."""

import pytest

from station.core.config_error import ConfigError, key_text
from station.core.errors import show


def test_all_problems_are_in_message_and_details():
    error = ConfigError(["a is 1.", "b is 2."], remedy="Correct it.")

    assert str(error) == "a is 1.\nb is 2."
    assert error.details == {"errors": ["a is 1.", "b is 2."]}
    assert error.remedy == "Correct it."
    assert isinstance(error, ValueError)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("a", "'a'"),
        ("x" * 100, f"'{'x' * 78}…"),
        (1 << 16_609, "an integer of 16610 bits"),
        (-7, "-7"),
    ],
    ids=["text", "long text", "long integer", "integer"],
)
def test_long_values_are_shown_in_part(value, text):
    assert show(value) == text


@pytest.mark.parametrize(
    ("path", "text"),
    [(("robot", "arms", 0, "base"), "robot.arms[0].base"), ((0, "a"), "[0].a")],
)
def test_path_of_a_key_is_written_with_dots_and_indices(path, text):
    assert key_text(path) == text
