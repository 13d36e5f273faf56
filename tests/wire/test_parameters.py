"""Parameters on the wire: any JSON that is not nested too deep."""

import pytest
from pydantic import ValidationError

from station.wire import ParameterRequest


@pytest.mark.parametrize("value", [1, 0.5, "x", True, None, [1, [2]], {"a": {"b": 1}}])
def test_a_value_is_any_json(value):
    assert ParameterRequest.model_validate({"value": value}).value == value


def test_a_value_that_is_nested_too_deep_is_refused():
    value = 1
    for _ in range(40):
        value = [value]
    with pytest.raises(ValidationError, match="nested deeper"):
        ParameterRequest.model_validate({"value": value})
