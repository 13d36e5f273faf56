"""What every wire model refuses."""

import math

import pytest
from pydantic import TypeAdapter, ValidationError

from station.wire import ControllerName, RequestModel, ResponseModel
from station.wire.base import MAX_DEPTH, ParameterValues


class Asked(RequestModel):
    """A number."""

    x: float


class Told(ResponseModel):
    """A number."""

    x: float


class Loaded(RequestModel):
    """Nested parameters."""

    params: ParameterValues


@pytest.mark.parametrize("value", [1, 1.5, -0.0, 1e300])
def test_numbers_are_numbers(value):
    assert Asked.model_validate({"x": value}).x == value


@pytest.mark.parametrize(
    "value", ["600", "", True, False, None, [1.0], math.nan, math.inf, -math.inf]
)
@pytest.mark.parametrize("kind", [Asked, Told])
def test_nothing_else_is_a_number(kind, value):
    with pytest.raises(ValidationError):
        kind.model_validate({"x": value})


def test_an_unknown_key_is_refused_in_a_request_and_ignored_in_an_answer():
    with pytest.raises(ValidationError, match="extra"):
        Asked.model_validate({"x": 1.0, "y": 1.0})
    assert Told.model_validate({"x": 1.0, "y": 1.0}).x == 1.0


@pytest.mark.parametrize("name", ["arm", "a.b-c_1", "7", "x" * 128])
def test_names_that_are_one_segment_of_a_url(name):
    assert TypeAdapter(ControllerName).validate_python(name) == name


@pytest.mark.parametrize(
    "name", ["", ".", "..", "-a", "a/b", "a b", "a\n", "ä", "a?", "x" * 129]
)
def test_names_that_are_not(name):
    with pytest.raises(ValidationError):
        TypeAdapter(ControllerName).validate_python(name)


def nested(depth, leaf=1.0):
    for _ in range(depth):
        leaf = {"a": [leaf]}
    return {"a": leaf}


def test_parameters_may_be_nested():
    values = nested(10)

    assert Loaded(params=values).params == values


@pytest.mark.parametrize("depth", [MAX_DEPTH, 500])
def test_parameters_nested_without_end_are_refused(depth):
    with pytest.raises(ValidationError):
        Loaded(params=nested(depth))


@pytest.mark.parametrize("leaf", [math.nan, math.inf, {1}, object()])
def test_parameters_that_json_cannot_have_are_refused(leaf):
    with pytest.raises(ValidationError):
        Loaded(params=nested(3, leaf))
