"""Gain sets on the wire."""

import pytest
from pydantic import TypeAdapter, ValidationError

from station.wire import GainSetRequest
from station.wire.gain_sets import GainSetName


def test_no_controllers_are_not_the_same_as_all():
    assert GainSetRequest().controllers is None
    with pytest.raises(ValidationError):
        GainSetRequest(controllers=[])


@pytest.mark.parametrize("name", ["", ".", "-a", "a/b", "a b", "x" * 101])
def test_names_are_segments_of_a_path(name):
    with pytest.raises(ValidationError):
        TypeAdapter(GainSetName).validate_python(name)
