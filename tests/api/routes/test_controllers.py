"""List, load, switch, unload."""

import pytest

from station.client import ApiError
from tests.api.test_errors import problem_of

SPRING = {"name": "spring", "type": "test/Spring", "params": {"joint": "j"}}


def names(operator):
    found = operator.get("/api/v1/controllers").json()["controllers"]
    return {controller["name"]: controller["state"] for controller in found}


def test_loading_answers_201_and_the_controller(operator):
    answer = operator.post("/api/v1/controllers", json=SPRING)

    assert answer.status_code == 201
    assert answer.json() | {"time": None} == {
        "name": "spring",
        "type": "test/Spring",
        "state": "initialized",
        "claimed_resources": [
            {
                "hardware_interface": "hardware_interface::EffortJointInterface",
                "resources": ["j"],
            }
        ],
        "fault": "",
        "traceback": "",
        "fallback": [],
        "time": None,
    }
    assert names(operator) == {"spring": "initialized"}


def test_loading_the_same_again_answers_200(operator):
    first = operator.post("/api/v1/controllers", json=SPRING)
    second = operator.post("/api/v1/controllers", json=SPRING)

    assert second.status_code == 200
    assert second.json() == first.json()
    assert names(operator) == {"spring": "initialized"}


@pytest.mark.parametrize(
    ("change", "status", "code"),
    [
        ({"params": {"joint": "j", "k": 3.0}}, 409, "controller_exists"),
        ({"name": "b", "type": "test/Nothing"}, 404, "controller_type_not_found"),
        ({"name": "b", "type": None, "params": {}}, 422, "invalid_parameter"),
        ({"name": "b", "params": {}}, 422, "invalid_parameter"),
        ({"name": "b", "params": {"joint": "nose"}}, 422, "controller_load_failed"),
        ({"name": "a/b"}, 422, "invalid_request"),
        ({"name": ".."}, 422, "invalid_request"),
        ({"name": ""}, 422, "invalid_request"),
        ({"name": 3}, 422, "invalid_request"),
        ({"name": "b", "kind": "x"}, 422, "invalid_request"),
        ({"name": "b", "params": [1]}, 422, "invalid_request"),
    ],
)
def test_a_load_that_is_refused_changes_nothing(operator, change, status, code):
    operator.post("/api/v1/controllers", json=SPRING)

    answer = operator.post("/api/v1/controllers", json={**SPRING, **change})

    problem_of(answer, status, code)
    assert names(operator) == {"spring": "initialized"}


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_parameters_that_are_not_finite_are_refused(operator, number):
    body = '{"name": "b", "type": "test/Spring", "params": {"joint": "j", "k": [%s]}}'

    answer = operator.post(
        "/api/v1/controllers",
        content=body % number,
        headers={"Content-Type": "application/json"},
    )

    problem_of(answer, 422, "invalid_request")
    assert names(operator) == {}


def test_switching_on_and_off(client):
    client.load_controller("spring", "test/Spring", {"joint": "j"})

    result = client.switch_controllers(start=["spring"])
    assert (result.ok, result.started, result.stopped) == (True, ["spring"], [])
    assert client.controller("spring").state == "running"

    result = client.switch_controllers(stop=["spring"])
    assert (result.started, result.stopped) == ([], ["spring"])
    assert client.controller("spring").state == "stopped"


def test_a_dry_run_changes_nothing(client):
    client.load_controller("spring", "test/Spring", {"joint": "j"})

    result = client.switch_controllers(start=["spring"], dry_run=True)

    assert result.dry_run
    assert result.started == ["spring"]
    assert client.controller("spring").state == "initialized"


def test_a_conflict_names_who_holds_the_joint(spring):
    spring.load_controller("other", "test/Spring", {"joint": "j"})

    with pytest.raises(ApiError) as caught:
        spring.switch_controllers(start=["other"])

    assert (caught.value.status, caught.value.code) == (409, "resource_conflict")
    assert "spring" in caught.value.detail
    assert caught.value.details
    assert spring.controller("other").state == "initialized"
    assert spring.controller("spring").state == "running"


@pytest.mark.parametrize(
    ("body", "status", "code"),
    [
        ({"start": ["nobody"]}, 404, "controller_not_found"),
        ({"stop": ["nobody"]}, 404, "controller_not_found"),
        ({"start": [], "stop": []}, 422, "invalid_request"),
        ({}, 422, "invalid_request"),
        ({"start": "spring"}, 422, "invalid_request"),
        ({"stop": ["spring"], "strictness": "hard"}, 422, "invalid_request"),
        ({"stop": ["spring"], "strictness": 2}, 422, "invalid_request"),
        ({"stop": ["spring"], "timeout": -1}, 422, "invalid_request"),
        ({"stop": ["spring"], "timeout": "1"}, 422, "invalid_request"),
        ({"stop": ["spring"], "timeout": False}, 422, "invalid_request"),
        ({"stop": ["spring"], "dry_run": "no"}, 422, "invalid_request"),
        ({"stop": ["spring"], "dry_run": 0}, 422, "invalid_request"),
        ({"stop": ["spring"], "asap": True}, 422, "invalid_request"),
    ],
)
@pytest.mark.usefixtures("spring")
def test_a_switch_that_is_refused_changes_nothing(operator, body, status, code):
    answer = operator.post("/api/v1/controllers/switch", json=body)

    problem_of(answer, status, code)
    assert names(operator) == {"spring": "running"}


def test_a_stopped_station_starts_nothing(spring):
    spring.stop()

    with pytest.raises(ApiError) as caught:
        spring.switch_controllers(start=["spring"])

    assert (caught.value.status, caught.value.code) == (423, "stopped")


def test_unloading_answers_the_last_state_of_the_controller(spring):
    spring.switch_controllers(stop=["spring"])

    assert spring.unload_controller("spring").state == "stopped"
    assert spring.controllers() == []


def test_a_running_controller_is_not_unloaded(spring):
    with pytest.raises(ApiError) as caught:
        spring.unload_controller("spring")

    assert (caught.value.status, caught.value.code) == (409, "controller_state")
    assert spring.controller("spring").state == "running"


@pytest.mark.parametrize("name", ["nobody", "a b", "ü", "%2e", "x" * 3000, "switch"])
def test_an_unknown_controller_is_a_404_that_lists_the_known(spring, name):
    with pytest.raises(ApiError) as caught:
        spring.controller(name)

    assert (caught.value.status, caught.value.code) == (404, "controller_not_found")
    assert "spring" in str(caught.value)


def test_types_are_listed(client):
    (spring,) = client.controller_types()

    assert spring.type == "test/Spring"
    assert spring.base_class
