"""Reports: dataclasses that core fills, the API sends and the client reads."""

import json
import math

import pytest
from pydantic import TypeAdapter, ValidationError

from station.reports import (
    ArmRecord,
    Event,
    EventKind,
    Percentiles,
    Simulation,
    described,
    examples_of,
)
from station.wire import Events
from station.wire.base import reader_of

SIMULATION = {"paused": True, "real_time_factor": 1.0, "time": 0.5, "steps_due": 0}


def test_unknown_keys_are_ignored_because_a_newer_station_may_add_some():
    assert (
        reader_of(Simulation)
        .validate_json(json.dumps({**SIMULATION, "wind": 1.0}))
        .paused
    )


@pytest.mark.parametrize("value", ["600", True, None, [1.0], math.nan])
def test_a_number_is_nothing_else(value):
    with pytest.raises(ValidationError):
        reader_of(Simulation).validate_json(json.dumps({**SIMULATION, "time": value}))
    with pytest.raises(ValidationError):
        TypeAdapter(Simulation).validate_python({**SIMULATION, "time": value})


def test_a_mapping_may_stand_for_a_report_and_a_text_for_a_word():
    values = {"events": examples_of(Event.__doc__), "newest_id": 17}

    (event,) = Events.model_validate(values).events

    assert event.kind is EventKind.REQUEST
    assert event.severity == "warning"


def test_numbers_that_are_not_finite_are_null_and_come_back_as_none():
    record = ArmRecord(1.0, (math.nan, 2.0), (), (), (), (math.inf,), ())
    text = TypeAdapter(ArmRecord).dump_json(record)

    read = reader_of(ArmRecord).validate_json(text)

    assert json.loads(text)["q"] == [None, 2.0]
    assert (read.q, read.tau_J_d) == ([None, 2.0], [None])


def test_the_schema_has_the_descriptions_and_examples_of_the_docstring():
    schema = TypeAdapter(Event).json_schema()

    assert schema["description"] == "An event at the station."
    assert (
        schema["properties"]["time"]["description"] == "Wall time [s since 1970, UTC]."
    )
    (example,) = schema["examples"]
    assert (
        reader_of(Event).validate_json(json.dumps(example)).result
        == "409 resource_conflict"
    )


def test_several_attributes_share_a_description_that_goes_on_in_the_next_line():
    text, attributes = described(
        "Do it.\n\nAttributes:\n    a, b: One\n        thing.\n    c: Two.\n"
    )

    assert text == "Do it."
    assert attributes == {"a": "One thing.", "b": "One thing.", "c": "Two."}


def test_a_docstring_may_have_several_examples_or_none():
    assert examples_of('A.\n\nExample:\n    {"a": 1}\n    {"a":\n    2}\n') == [
        {"a": 1},
        {"a": 2},
    ]
    assert examples_of(Percentiles.__doc__) == []
