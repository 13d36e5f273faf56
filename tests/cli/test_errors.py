"""Whatever goes wrong is worded for people and for programs."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from station.cli.errors import UsageError, failure_of
from station.client import (
    ApiError,
    MotionError,
    NotFiniteError,
    StationUnreachableError,
    StreamTimeoutError,
    UnknownPoseError,
)
from station.core.installation import install_command
from station.local.station_locator import NoStationError
from station.wire import CommandRequest, FieldError, StopState

ROOT = Path(__file__).parents[2]


def test_error_of_the_station_keeps_its_words():
    failure = failure_of(NoStationError("None runs.", remedy="Start one."))

    assert failure.as_problem() == {
        "code": "no_station",
        "detail": "None runs.",
        "remedy": "Start one.",
    }
    assert not failure.is_usage
    assert failure_of(UsageError("No.")).is_usage


def test_every_field_error_is_told():
    fields = [FieldError(field="j1/p", value="-1", message="allowed is 0 to 1")]

    failure = failure_of(
        ApiError("Gain 'j1/p'.", status=422, code="invalid_gain", errors=fields)
    )

    assert "j1/p: " in failure.detail
    assert "allowed is 0 to 1" in failure.detail


def test_unreachable_station_is_told():
    failure = failure_of(StationUnreachableError("http://x", OSError("refused")))

    assert failure.code == "unreachable"
    assert "http://x" in failure.detail


@pytest.mark.parametrize(
    "error",
    [
        MotionError("6 positions were given for 7 joints.", "Give 7."),
        UnknownPoseError("There is no pose 'Ready'.", "Name another one."),
        StreamTimeoutError("loop", 1.0),
        NotFiniteError("seconds", float("nan")),
    ],
)
def test_every_error_of_the_client_is_told(error):
    failure = failure_of(error)

    assert (failure.code, failure.detail) == (error.code, error.detail)
    assert failure.remedy == error.remedy


def test_what_cannot_be_sent_is_told():
    with pytest.raises(ValidationError) as caught:
        CommandRequest(command=[0.0, float("nan")])

    failure = failure_of(caught.value)

    assert "command.1 is nan" in failure.detail
    assert "Nothing was sent" in failure.remedy


def test_answer_that_is_not_understood_is_told():
    with pytest.raises(ValidationError) as caught:
        StopState.model_validate({"state": "asleep", "reason": "", "epoch": 1})

    failure = failure_of(caught.value)

    assert failure.code == "unexpected_answer"
    assert "state is 'asleep'" in failure.detail


def test_defects_are_nobodys_failure():
    assert failure_of(ZeroDivisionError()) is None


def test_missing_package_is_told_with_the_extra_that_brings_it():
    failure = failure_of(ModuleNotFoundError("No module", name="mujoco.viewer"))

    assert failure.detail.startswith("The package 'mujoco' is not installed")
    assert failure.remedy.startswith(f"Install it: {install_command('sim')}")


def test_missing_module_of_the_program_itself_is_a_defect():
    assert failure_of(ModuleNotFoundError("No module", name="station.nothing")) is None
