"""Whatever goes wrong is worded for people and for programs."""

import re
from pathlib import Path

import pytest
from pydantic import ValidationError

from station.api.errors import ROUTES, STATUS
from station.cli.errors import REMEDIES, UsageError, failure_of, for_terminal
from station.cli.parser import parse
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
from station.wire import (
    CommandRequest,
    ControlRequest,
    FieldError,
    GoalRequest,
    LoadRequest,
    ResetRequest,
    SceneObjectRequest,
    StopState,
)
from station.wire.robots import GraspEpsilon

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

    failure = failure_of(caught.value, {"command": "V"})

    assert failure.detail == "V number 2: must be a finite number (it is nan)."
    assert "Nothing was sent" in failure.remedy


@pytest.mark.parametrize(
    ("make", "detail"),
    [
        (
            lambda: GraspEpsilon(inner=-1.0),
            "--inner: must be at least 0.0 (it is -1.0).",
        ),
        (
            lambda: LoadRequest(name="a/b"),
            "name: must have letters A to Z, digits and _ . - alone, no sign but _ at "
            "first (it is 'a/b').",
        ),
        (
            lambda: ControlRequest(owner="!Ada"),
            "--owner: must have letters of any language, digits, spaces and _ . @ + - "
            "alone, no sign but _ at first (it is '!Ada').",
        ),
        (
            lambda: ResetRequest(joint_positions={"j1": float("inf")}),
            "j1: must be a finite number (it is inf).",
        ),
        (
            lambda: GoalRequest(goal={"a": [{"time_from_start": float("nan")}]}),
            "goal/a/0/time_from_start: must be a finite number (it is nan).",
        ),
        (
            lambda: SceneObjectRequest(size=[0.1, float("nan"), 0.1]),
            "size: must be a finite number (it is nan).",
        ),
    ],
)
def test_a_wrong_field_has_the_name_that_was_typed(make, detail):
    with pytest.raises(ValidationError) as caught:
        make()
    typed = {"inner": "--inner", "joint_positions": "JOINT=POSITION"}
    typed["owner"] = "--owner"

    failure = failure_of(caught.value, typed)

    assert (failure.code, failure.detail) == ("invalid_request", detail)


def test_a_field_that_the_station_refuses_is_told_once_as_it_was_typed():
    fields = [
        FieldError(field="query/limit", value="'0'", message="must be at least 1"),
        FieldError(field="query/kind/0", value="'x'", message="must be 'stop'"),
    ]
    detail = "query/limit: must be at least 1 (it is '0'). There is one more error."
    error = ApiError(detail, status=422, code="invalid_request", errors=fields)

    failure = failure_of(error, {"limit": "--count", "kind": "--kind"})

    assert failure.detail == (
        "--count: must be at least 1 (it is '0'); --kind: must be 'stop' (it is 'x')."
    )
    assert failure.remedy == "Nothing changed. Correct the value and try again."
    assert [error["field"] for error in failure.errors] == [
        "query/limit",
        "query/kind/0",
    ]


def test_an_error_that_the_detail_has_is_not_told_again():
    error = FieldError(field="p", value="", message="is too large")
    error = ApiError("p is too large.", status=422, code="x", errors=[error])

    assert failure_of(error).detail == "p is too large."


def test_answer_that_is_not_understood_is_told():
    with pytest.raises(ValidationError) as caught:
        StopState.model_validate({"state": "asleep", "reason": "", "epoch": 1})

    failure = failure_of(caught.value)

    assert failure.code == "unexpected_answer"
    assert "state: must be 'armed', 'stopped' or 'released' (it is 'asleep')" in (
        failure.detail
    )


def test_defects_are_nobodys_failure():
    assert failure_of(ZeroDivisionError()) is None


def test_missing_package_is_told_with_the_extra_that_brings_it():
    failure = failure_of(ModuleNotFoundError("No module", name="mujoco.viewer"))

    assert failure.detail.startswith("The package 'mujoco' is not installed")
    assert failure.remedy.startswith(f"Install it: {install_command('sim')}")


def test_missing_module_of_the_program_itself_is_a_defect():
    assert failure_of(ModuleNotFoundError("No module", name="station.nothing")) is None


WITHOUT_VERB = {"goal_not_found", "loop", "plot_layout_not_found", "stale_epoch"}
WITHOUT_VERB |= {"waypoint_path_not_found"}


def test_every_hint_at_a_route_becomes_a_verb():
    assert set(ROUTES) - set(REMEDIES) == WITHOUT_VERB

    for code, hint in ROUTES.items():
        told = for_terminal(code, f"Choose another one. {hint}")
        assert told == " ".join([
            "Choose another one.",
            *REMEDIES.get(code, "").split(),
        ])


@pytest.mark.parametrize(
    "line", re.findall(r"`station ([^`]+)`", " ".join(REMEDIES.values()))
)
def test_the_verbs_exist(line, capsys):
    try:
        parse(line.split())
    except SystemExit:
        # A name is still to be given; the verb and its actions are known.
        told = capsys.readouterr().err
        assert "arguments are required" in told, told


def test_the_codes_exist():
    assert set(REMEDIES) - {"no_sample"} <= {kind.code for kind in STATUS}


@pytest.mark.parametrize(
    ("remedy", "told"),
    [
        ("", ""),
        ("Send fewer.", "Send fewer."),
        ("Recover it (POST /robots/panda/error_recovery).", "Recover it."),
        ("List them: GET /api/v1/agents/requests.", "List them."),
        ("Wait. See GET /status for a stop.", "Wait."),
    ],
)
def test_sentences_about_routes_are_left_out(remedy, told):
    assert for_terminal("other", remedy) == told
