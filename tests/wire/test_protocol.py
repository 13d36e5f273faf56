"""The envelope of errors and of frames."""

import pytest
from pydantic import ValidationError

from station.reports import examples_of
from station.wire import FieldError, Problem, StreamFrame

EXAMPLE = examples_of(Problem.__doc__)[0]


def test_the_example_is_valid():
    problem = Problem.model_validate(EXAMPLE)

    assert problem.errors is None
    assert problem.details is None


@pytest.mark.parametrize("status", [200, 399, 600])
def test_only_errors_are_problems(status):
    with pytest.raises(ValidationError):
        Problem.model_validate({**EXAMPLE, "status": status})


def test_fields_are_told_one_by_one():
    problem = Problem.model_validate({
        **EXAMPLE,
        "errors": [{"field": "a", "message": "m"}],
    })

    assert problem.errors == [FieldError(field="a", message="m", value="")]


def test_a_frame_needs_no_boot_id():
    frame = StreamFrame.model_validate_json(
        '{"topic": "t", "seq": 1, "epoch": 2, "stamp": 0.5, "data": {"a": [null, 1]}}'
    )

    assert frame.boot_id == ""
    assert frame.data == {"a": [None, 1]}
