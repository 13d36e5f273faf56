"""Names of people and tokens."""

import pytest
from pydantic import ValidationError

from station.wire import ControlRequest, TokenRequest


@pytest.mark.parametrize("name", ["Ada", "Dr. Grace Hopper", "ada@lab", "Ölaf"])
def test_people_have_names(name):
    assert ControlRequest(owner=name).owner == name


@pytest.mark.parametrize("name", ["", " Ada", "a\nb", "x" * 101])
def test_what_would_garble_a_log_is_no_name(name):
    with pytest.raises(ValidationError):
        ControlRequest(owner=name)


@pytest.mark.parametrize("expires", [0.0, -1.0, float("inf"), "60"])
def test_a_token_lives_for_a_finite_time(expires):
    with pytest.raises(ValidationError):
        TokenRequest(name="ada", expires=expires)
