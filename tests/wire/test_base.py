"""What every wire model refuses."""

import math
from enum import Enum
from types import SimpleNamespace
from typing import Annotated, Literal

import pytest
from pydantic import Field, TypeAdapter, ValidationError

from station.wire import ControllerName, RequestModel, ResponseModel
from station.wire.base import (
    MAX_DEPTH,
    FromEnum,
    Items,
    Measured,
    Measurements,
    ParameterValues,
    Reason,
)


class Asked(RequestModel):
    """A number."""

    x: float


class Told(ResponseModel):
    """A number."""

    x: float


class Mode(Enum):
    """A mode that libfranka numbers."""

    IDLE = 1


class State(Enum):
    """A state that has its name on the wire as its value."""

    RUNNING = "is running"


class Report(ResponseModel):
    """An answer that is read from a value of the core."""

    mode: Annotated[Literal["idle"], FromEnum]
    state: Annotated[Literal["is running"], FromEnum]
    value: Measured
    values: Measurements
    names: Items[str]
    remedy: Reason


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


def test_an_answer_is_read_from_the_attributes_of_a_value():
    value = SimpleNamespace(
        mode=Mode.IDLE,
        state=State.RUNNING,
        value=math.inf,
        values=(math.nan, 1.0),
        names=("j1", "j2"),
        remedy=None,
    )

    assert Report.model_validate(value).model_dump() == {
        "mode": "idle",
        "state": "is running",
        "value": None,
        "values": [None, 1.0],
        "names": ["j1", "j2"],
        "remedy": "",
    }


@pytest.mark.parametrize(
    "wrong", [{"mode": 1}, {"value": "1.0"}, {"values": "12"}, {"names": [1]}]
)
def test_an_answer_is_still_strict(wrong):
    right = {
        "mode": "idle",
        "state": "is running",
        "value": 1.0,
        "values": [1.0],
        "names": ["j1"],
        "remedy": "",
    }
    assert Report.model_validate(right)

    with pytest.raises(ValidationError):
        Report.model_validate({**right, **wrong})


class Sized(ResponseModel):
    """A thing with a size.

    More about it.

    Attributes:
        width, height: How far it goes
            in each direction [m].
        plain: Just this.
    """

    width: float
    height: float
    plain: Annotated[str, Field(alias="simple")]


class Coloured(Sized):
    """A thing with a colour.

    Attributes:
        colour: Its colour.
    """

    colour: str


def test_the_schema_describes_fields_as_the_docstring_does():
    schema = Coloured.model_json_schema()
    properties = schema["properties"]

    assert schema["description"] == "A thing with a colour."
    assert Sized.model_json_schema()["description"] == (
        "A thing with a size. More about it."
    )
    assert properties["height"]["description"] == (
        "How far it goes in each direction [m]."
    )
    assert properties["simple"]["description"] == "Just this."
    assert properties["colour"]["description"] == "Its colour."
