"""Every error has a status, and every refusal is a problem document."""

import json
import math
import re
from pathlib import Path

import pytest
from fastapi import FastAPI

from station.api.errors import (
    ROUTES,
    STATUS,
    ProblemError,
    problem_response,
    station_error_response,
    status_of,
)
from station.core import errors
from station.core.errors import StationError
from tests.api.openapi_document import operations
from tests.for_each import for_each

ALL = [
    kind
    for kind in vars(errors).values()
    if isinstance(kind, type) and issubclass(kind, StationError)
]


def read(response):
    return json.loads(bytes(response.body))


@for_each("kind", ALL)
def test_every_error_of_the_tree_is_mapped(kind):
    assert kind in STATUS
    assert 400 <= status_of(kind) < 600


@for_each("kind", [k for k in ALL if k is not StationError])
def test_an_error_of_the_station_reaches_the_client_word_by_word(kind):
    sentence = "Joint 'a' is 3; allowed is 2."
    # A configuration may have several mistakes, of which the error tells all.
    told = [sentence] if kind is errors.ConfigError else sentence
    response = station_error_response(kind(told, remedy="x"))

    problem = read(response)
    assert response.media_type == "application/problem+json"
    assert response.status_code == problem["status"] == status_of(kind)
    assert problem["detail"] == sentence
    assert problem["remedy"].partition(" ")[0] == "x"
    assert problem["code"] == kind.code
    assert problem["type"].endswith(kind.code)
    assert problem["title"]


def test_a_new_kind_of_error_gets_the_status_of_its_parent():
    class SpecialConflictError(errors.ResourceConflictError):
        pass

    assert status_of(SpecialConflictError) == 409


def test_details_that_json_has_no_word_for_become_null_or_text():
    error = errors.ParameterError("x", details={"a": math.nan, "b": {1}, 3: 4})

    details = read(station_error_response(error))["details"]
    assert details == {"a": None, "b": "{1}", "3": 4}


def test_listed_errors_become_the_errors_of_the_problem():
    error = errors.InvalidGainError(
        "x", details={"errors": [{"field": "p", "value": "-1", "message": "too small"}]}
    )

    problem = read(station_error_response(error))
    assert problem["errors"] == [{"field": "p", "value": "-1", "message": "too small"}]
    assert "details" not in problem


def test_a_problem_of_the_api_carries_its_headers():
    error = ProblemError(401, "unauthorized", "no", "do", {"WWW-Authenticate": "x"})

    response = error.response()
    assert response.headers["www-authenticate"] == "x"
    assert read(response)["title"] == "Unauthorized"


def test_a_problem_without_errors_has_no_empty_list():
    assert set(read(problem_response(404, "a_b", "d", "r"))) == {
        "type",
        "title",
        "status",
        "detail",
        "code",
        "remedy",
    }


def problem_of(answer, status, code):
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert problem["code"] == code
    assert problem["status"] == status
    assert problem["detail"]
    assert problem["remedy"]
    return problem


def test_an_unknown_route_is_a_problem(operator):
    problem_of(operator.get("/api/v1/nothing"), 404, "route_not_found")


def test_a_wrong_method_is_a_problem_and_names_the_right_ones(operator):
    answer = operator.delete("/api/v1/loop")

    problem_of(answer, 405, "method_not_allowed")
    assert answer.headers["allow"] == "GET"


def test_an_unexpected_exception_is_a_problem_without_its_secrets(app: FastAPI, http):
    @app.get("/boom")
    def boom():
        raise ZeroDivisionError("secret")

    problem = problem_of(http.get("/boom"), 500, "internal_error")
    assert "ZeroDivisionError" in problem["detail"]
    assert "secret" not in json.dumps(problem)


@pytest.mark.parametrize(
    ("body", "status", "code"),
    [
        (b"{", 422, "invalid_request"),
        (b"[1, 2]", 422, "invalid_request"),
        (b"null", 422, "invalid_request"),
        (b"", 422, "invalid_request"),
        (b"\xff\xfe\x00", 422, "invalid_request"),
        (b"[" * 5000, 422, "invalid_request"),
        (b'{"command": [' + b"9" * 5000 + b"]}", 422, "invalid_request"),
        (b'{"command": [1e999]}', 422, "invalid_request"),
        (b'{"command": [' + b"9" * 400 + b"]}", 422, "invalid_request"),
    ],
)
def test_a_body_that_is_no_json_object_is_a_problem(operator, body, status, code):
    answer = operator.put(
        "/api/v1/controllers/spring/command",
        content=body,
        headers={"Content-Type": "application/json"},
    )

    problem_of(answer, status, code)


def test_a_validation_problem_names_field_and_value(operator):
    answer = operator.put(
        "/api/v1/controllers/spring/command", json={"command": [0.1, "abc"]}
    )

    problem = problem_of(answer, 422, "invalid_request")
    assert problem["errors"] == [
        {
            "field": "body/command/1",
            "message": "must be a number",
            "value": "'abc'",
        }
    ]
    assert "body/command/1" in problem["detail"]
    assert "'abc'" in problem["detail"]


@pytest.mark.parametrize(
    ("body", "detail"),
    [
        (
            {"timeout": None, "start": ["arm"]},
            "timeout: must be a number (it is null).",
        ),
        ({"start": None}, "start: must be a list (it is null)."),
    ],
)
def test_null_is_a_value_that_a_problem_names(operator, body, detail):
    answer = operator.post("/api/v1/controllers/switch", json=body)

    assert detail in answer.json()["detail"]


def test_a_field_that_is_missing_has_no_value(operator):
    problem = operator.put("/api/v1/controllers/spring/command", json={}).json()

    assert problem["detail"].endswith("is missing.")


def test_the_route_that_helps_follows_the_remedy():
    error = errors.StoppedError("The station is stopped.", remedy="Release the stop.")

    remedy = json.loads(station_error_response(error).body)["remedy"]

    assert remedy.startswith("Release the stop. POST /api/v1/stop/release ")


def test_every_hint_is_of_an_error_there_is_and_of_a_route_there_is():
    codes = {kind.code for kind in STATUS}

    assert set(ROUTES) <= codes
    for hint in ROUTES.values():
        method, path = hint.split()[:2]
        assert (method, path) in operations(), hint
        assert hint.endswith(".")


def test_the_core_and_the_robots_name_no_routes():
    route = re.compile(r"\b(GET|POST|PUT|PATCH|DELETE) /")
    package = Path(__file__).parents[2] / "station"
    modules = [*(package / "core").rglob("*.py"), *(package / "hw").rglob("*.py")]

    assert [path.name for path in modules if route.search(path.read_text())] == []
