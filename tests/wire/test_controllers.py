"""Wire models of controllers."""

import pytest
from pydantic import TypeAdapter, ValidationError

from station.reports import examples_of
from station.wire import (
    CommandRequest,
    Gains,
    GainSetRequest,
    GainsPatch,
    LoadRequest,
    SwitchRequest,
    SwitchResult,
    Tunable,
)
from station.wire.controllers import GainSetName


@pytest.mark.parametrize(
    "kind", [LoadRequest, SwitchRequest, SwitchResult, GainsPatch, CommandRequest]
)
def test_examples_are_valid(kind):
    for example in examples_of(kind.__doc__):
        assert kind.model_validate(example)


def test_the_schema_of_gains_is_called_schema_on_the_wire():
    gains = Gains(values={"p": 1.0}, schema={"p": Tunable()}, revision=1, etag='"x"')

    text = gains.model_dump_json(by_alias=True)
    assert '"schema":' in text
    assert Gains.model_validate_json(text) == gains


def test_a_switch_must_name_something():
    with pytest.raises(ValidationError, match="at least one controller"):
        SwitchRequest()


def test_a_switch_is_strict_unless_asked_otherwise():
    assert SwitchRequest(start=["a"]).strictness == "strict"


@pytest.mark.parametrize("timeout", [-0.1, 60.1])
def test_a_switch_does_not_wait_for_ever(timeout):
    with pytest.raises(ValidationError):
        SwitchRequest(start=["a"], timeout=timeout)


def test_no_controllers_are_not_the_same_as_all():
    assert GainSetRequest().controllers is None
    with pytest.raises(ValidationError):
        GainSetRequest(controllers=[])


@pytest.mark.parametrize("name", ["", ".", "-a", "a/b", "a b", "x" * 101])
def test_names_are_segments_of_a_path(name):
    with pytest.raises(ValidationError):
        TypeAdapter(GainSetName).validate_python(name)
