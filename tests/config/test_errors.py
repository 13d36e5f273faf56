"""A configuration error names every problem at once."""

from station.config.errors import ConfigError


def test_all_problems_are_in_message_and_details():
    error = ConfigError(["a is 1.", "b is 2."], remedy="Correct it.")

    assert str(error) == "a is 1.\nb is 2."
    assert error.details == {"errors": ["a is 1.", "b is 2."]}
    assert error.remedy == "Correct it."
    assert isinstance(error, ValueError)
