"""Refusals in the station's own words: which field, its value, what is allowed."""

import re

import pytest
from pydantic_core._pydantic_core import list_all_errors

from station.wire.validation_words import explain, explain_json

PYDANTIC = re.compile(
    r"Input should|Field required|valid (integer|number|string|dictionary)|Extra inputs"
    r"|Value error"
)
JSON = {"Content-Type": "application/json"}


def test_no_word_of_the_validator_is_handed_on():
    for error in list_all_errors():
        said = explain(error["type"], error.get("example_context") or {})
        assert not PYDANTIC.search(said), said


@pytest.mark.parametrize(
    ("body", "detail"),
    [
        ('{"start": "arm"}', "body/start: must be a list (it is 'arm')."),
        ('{"stat": []}', "body/stat: is no field of this request."),
        (
            '{"start": ["a"], "timeout": "1"}',
            "timeout: must be a number (it is '1')",
        ),
        ('{"start": ["a"], "timeout": 99}', "body/timeout: must be at most 60"),
        (
            '{"start": ["a"], "strictness": "no"}',
            "must be 'strict', 'best_effort', 'auto' or 'force_auto'",
        ),
        ("{}", "body: name at least one controller in 'start' or 'stop'."),
        ("[]", "body: must be an object."),
        ('{"start": ["a"], "timeout": NaN}', "at character 28: JSON has no NaN"),
        ('{"start": ["a"], "timeout": -Infinity}', "JSON has no Infinity"),
        ('{"start": ["a"],}', "is no JSON: trailing comma is not allowed, at ',}' at"),
        ('{"start": ["a"', "is no JSON: unexpected end of data, at its end"),
        ("   ", "is empty, where a JSON object is expected"),
        (b'{"start": ["\xff"]}', "body: is no JSON: it is no text in UTF-8."),
    ],
)
def test_a_refusal_says_which_field_its_value_and_what_is_allowed(
    operator, body, detail
):
    url = "/api/v1/controllers/switch"
    answer = operator.post(url, content=body, headers=JSON)

    problem = answer.json()
    assert answer.status_code == 422
    assert detail in problem["detail"]
    assert not PYDANTIC.search(answer.text)


@pytest.mark.parametrize(
    ("step", "detail"),
    [
        ({"kind": "dance"}, "body/steps/0: has the kind 'dance'; allowed are 'set_poi"),
        ({}, "body/steps/0: has no kind."),
    ],
)
def test_a_step_of_no_known_kind_is_told_the_kinds(operator, step, detail):
    answer = operator.post("/api/v1/rehearse", json={"steps": [step]})

    assert answer.status_code == 422
    assert detail in answer.json()["detail"]


@pytest.mark.parametrize("body", [b"{nan}", '{"a": nan}', b"\xff", None])
def test_any_body_that_is_no_json_is_explained(body):
    assert "no JSON" in explain_json(body, 1, "unexpected: line 1")
