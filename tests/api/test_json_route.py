"""Bodies are parsed strictly."""

import pytest

from tests.api.test_errors import problem_of


@pytest.mark.parametrize(
    "number", ["NaN", "Infinity", "-Infinity", "1e999", "+1", "01"]
)
def test_nan_and_infinity_in_a_json_body_are_refused(operator, number):
    answer = operator.put(
        "/api/v1/controllers/spring/command",
        content=f'{{"command": [{number}]}}',
        headers={"Content-Type": "application/json"},
    )

    problem = problem_of(answer, 422, "invalid_request")
    assert "body" in problem["detail"]


def test_text_is_read_as_unicode(operator, station):
    operator.post("/api/v1/stop", json={"reason": "Rauch über dem Roboter 🔥"})

    assert station.loop.stop_latch.reason == "Rauch über dem Roboter 🔥"


@pytest.mark.parametrize("kind", ["application/x-www-form-urlencoded", "text/plain"])
def test_a_body_of_another_type_is_refused_and_the_header_named(operator, kind):
    answer = operator.put(
        "/api/v1/controllers/spring/command",
        content='{"command": [1.0]}',
        headers={"Content-Type": kind},
    )

    problem = problem_of(answer, 415, "unsupported_media_type")
    assert kind in problem["detail"]
    assert "Content-Type: application/json" in problem["remedy"]


def test_a_body_without_content_type_is_refused(operator):
    answer = operator.put(
        "/api/v1/controllers/spring/command", content='{"command": [1.0]}'
    )

    assert "of no type" in problem_of(answer, 415, "unsupported_media_type")["detail"]


def test_json_of_a_named_kind_is_json(operator):
    answer = operator.post(
        "/api/v1/stop/release",
        content='{"arm": "yes"}',
        headers={"Content-Type": "Application/merge-patch+JSON; charset=utf-8"},
    )

    problem_of(answer, 422, "invalid_request")


@pytest.mark.parametrize(
    ("params", "allowed"),
    [
        ({"points": [[0.5] * 7] * 2499}, True),
        ({"points": [[0.5] * 7] * 2501}, False),
        ({str(i): i for i in range(1000)}, True),
        ({str(i): i for i in range(1001)}, False),
        ({"deep": [[[1]]] * 7000}, False),
    ],
)
def test_a_body_of_too_many_values_is_refused_before_it_is_judged(
    operator, params, allowed
):
    answer = operator.post(
        "/api/v1/controllers", json={"name": "many", "type": "none", "params": params}
    )

    if allowed:
        problem_of(answer, 404, "controller_type_not_found")
    else:
        problem = problem_of(answer, 413, "body_too_large")
        assert "allowed" in problem["detail"]


@pytest.mark.parametrize(
    ("method", "url", "allowed"),
    [
        ("PUT", "controllers/spring/command?certificat=kept", "certificate"),
        ("POST", "controllers/switch?dry_run=true", "certificate"),
        ("POST", "gain-sets/undo?count=2", "none"),
        ("GET", "events?after=3", "kind, limit"),
        ("POST", "recordings/upload?nam=tuesday", "name"),
    ],
)
def test_an_unknown_parameter_of_a_query_is_refused(
    operator, spring, method, url, allowed
):
    body = {"command": [0.5]} if method == "PUT" else {"stop": ["spring"]}
    answer = operator.request(
        method, f"/api/v1/{url}", json=None if method == "GET" else body
    )

    problem = problem_of(answer, 422, "invalid_request")
    assert url.partition("?")[2].partition("=")[0] in problem["detail"]
    assert allowed in problem["detail"]
    assert spring.controller("spring").state == "running"


def test_a_stranger_is_not_told_what_a_query_may_have(http):
    problem_of(http.get("/api/v1/events?after=3"), 401, "unauthorized")


@pytest.mark.usefixtures("spring")
@pytest.mark.parametrize(
    ("body", "key"),
    [
        ('{"command": [0.5], "command": [0.1]}', "command"),
        ('{"command": [0.5], "comm\\u0061nd": [0.1]}', "command"),
        ('{"params": {"gains": [{"p": 1.0, "i": 2.0, "p" : 3.0}]}}', "p"),
    ],
)
def test_a_key_that_is_there_twice_is_refused_by_name(operator, body, key):
    before = operator.get("/api/v1/controllers/spring/command").json()

    answer = operator.put(
        "/api/v1/controllers/spring/command",
        content=body,
        headers={"Content-Type": "application/json"},
    )

    problem = problem_of(answer, 422, "invalid_request")
    assert f"the key '{key}' twice" in problem["detail"]
    assert operator.get("/api/v1/controllers/spring/command").json() == before


def test_keys_that_other_objects_and_texts_have_too_are_taken(operator):
    tree = {"one": {"p": 1.0}, "two": {"p": 1.0}, "note": '{"p": 1, "p": ": "}'}

    answer = operator.put("/api/v1/parameters/gains", json={"value": tree})

    assert answer.is_success
    assert operator.get("/api/v1/parameters/gains").json()["value"] == tree


@pytest.mark.parametrize(("depth", "status"), [(198, 422), (199, 413), (1000, 413)])
def test_a_body_of_too_many_levels_is_refused(operator, depth, status):
    answer = operator.put(
        "/api/v1/controllers/spring/command",
        content='{"command": ' + "[" * depth + '":"' + "]" * depth + "}",
        headers={"Content-Type": "application/json"},
    )

    assert answer.status_code == status


@pytest.mark.parametrize(
    ("method", "path", "detail"),
    [
        ("GET", "controllers/a%2Fb", "No controller 'a/b' is loaded."),
        ("GET", "controllers/a%2fb/gains", "No controller 'a/b' is loaded."),
        ("DELETE", "scene/a%2Fb", "The scene has no object 'a/b'."),
        ("GET", "parameters/a%2Fb", "There is no parameter 'a/b'."),
        ("GET", "hardware%2Fcomponents", "GET /api/v1/hardware%2Fcomponents"),
    ],
)
def test_a_name_with_a_slash_is_unknown_as_any_other(operator, method, path, detail):
    answer = operator.request(method, f"/api/v1/{path}")

    assert answer.status_code == 404
    assert answer.json()["detail"].startswith(detail)


def test_a_parameter_that_is_given_twice_is_refused_unless_it_takes_several(operator):
    twice = operator.get("/api/v1/events?limit=1&limit=2")
    several = operator.get("/api/v1/events?kind=stop&kind=switch")

    problem = problem_of(twice, 422, "invalid_request")
    assert problem["detail"] == (
        "The query has the parameter 'limit' 2 times; it has one value."
    )
    assert several.status_code == 200
