"""List, load, switch, unload."""

import sys
import threading

import pytest

from station.client import ApiError, StationClient
from station.core.control import controller_factory, switching
from station.core.control.controller_loader import TableLoader
from station.wire import controllers
from tests.api.conftest import OPERATOR
from tests.api.spring import Spring
from tests.api.test_errors import problem_of
from tests.waiting import PATIENCE

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
        "fault": None,
        "traceback": None,
        "fallback": [],
        "time": None,
        "notes": [],
        "update_rate": 1000.0,
        "async_update": None,
    }
    assert names(operator) == {"spring": "initialized"}


def test_chains_are_no_controller_of_that_name(operator):
    operator.post("/api/v1/controllers", json=SPRING)

    answer = operator.get("/api/v1/controllers/chains").json()

    assert [one["name"] for one in answer["controllers"]] == ["spring"]
    assert answer["controllers"][0]["is_in_chained_mode"] is False


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
    common = spring.parameters[1]
    assert (common.name, common.type) == ("allow_start_jump", "boolean")
    assert (common.required, common.default) == (False, False)


def test_a_module_outside_of_the_list_is_refused_with_the_line_that_allows_it(operator):
    answer = operator.post(
        "/api/v1/controllers", json={"name": "joke", "type": "antigravity:X"}
    )

    problem = problem_of(answer, 403, "controller_module_refused")
    line = "under 'station': controller_modules: [tests.api.spring, antigravity]"
    assert line in problem["remedy"]
    assert "antigravity" not in sys.modules


class SlowSpring(Spring):
    """Its init waits until the test lets it go on."""

    reached = threading.Event()
    go_on = threading.Event()

    def init(self, interface, params):
        """Wait."""
        SlowSpring.reached.set()
        SlowSpring.go_on.wait(PATIENCE)
        super().init(interface, params)


@pytest.fixture
def loading(station, live):
    """Load `slow` in a thread; return a client, and a list for the refusal."""
    SlowSpring.reached.clear()
    SlowSpring.go_on.clear()
    station.manager.register_loader(TableLoader({"test/Slow": SlowSpring}))
    refusals = []

    def load():
        try:
            live.load_controller("slow", "test/Slow", {"joint": "j"}, timeout=30.0)
        except ApiError as error:
            refusals.append(error)

    thread = threading.Thread(target=load)
    thread.start()
    assert SlowSpring.reached.wait(PATIENCE)
    yield refusals, thread
    SlowSpring.go_on.set()
    thread.join(PATIENCE)
    for each in threading.enumerate():
        if each.name == "load slow":
            each.join(PATIENCE)


def test_deleting_a_controller_that_is_loading_cancels_it(server, loading):
    refusals, thread = loading
    with StationClient(server.url, OPERATOR) as other:
        assert other.controller("slow").state == "loading"
        other.load_controller("quick", "test/Spring", {"joint": "j"})

        assert other.unload_controller("slow").state == "loading"

        thread.join(PATIENCE)
        assert [(e.status, e.code) for e in refusals] == [
            (422, "controller_load_failed")
        ]
        assert "was cancelled" in refusals[0].detail
        assert [c.name for c in other.controllers()] == ["quick"]


@pytest.mark.usefixtures("loading")
def test_a_controller_that_is_being_loaded_cannot_be_loaded_again(server):
    with (
        StationClient(server.url, OPERATOR) as other,
        pytest.raises(ApiError, match="being loaded") as caught,
    ):
        other.load_controller("slow", "test/Slow", {"joint": "j"})

    assert caught.value.status == 409


def test_loading_that_takes_longer_than_its_timeout_is_refused(station, client):
    station.manager.register_loader(TableLoader({"test/Slow": SlowSpring}))
    SlowSpring.go_on.clear()

    with pytest.raises(ApiError, match=r"not loaded within 0\.05 s"):
        client.load_controller("slow", "test/Slow", {"joint": "j"}, timeout=0.05)

    SlowSpring.go_on.set()
    for each in threading.enumerate():
        if each.name == "load slow":
            each.join(PATIENCE)
    assert client.controllers() == []


def test_the_default_limits_are_those_of_the_core():
    assert controllers.LOAD_TIMEOUT == controller_factory.LOAD_TIMEOUT
    assert controllers.SWITCH_BOUND == switching.SWITCH_BOUND


@pytest.mark.parametrize("bound", [0.5, None])
def test_the_bound_and_the_outcome_of_a_switch_reach_the_core(
    station, client, monkeypatch, bound
):
    client.load_controller("spring", "test/Spring", {"joint": "j"})
    asked = []

    def switch(request):
        asked.append(request)
        plan = switching.SwitchPlan((), (), (), (), (), ())
        outcome = switching.SwitchOutcome.ROLLED_BACK
        return switching.SwitchResult(
            ok=False, started=(), stopped=(), cycle=3, plan=plan, outcome=outcome
        )

    monkeypatch.setattr(station.manager, "switch_controller", switch)

    result = client.switch_controllers(start=["spring"], bound=bound)

    assert asked[0].bound == bound
    assert (result.ok, result.outcome) == (False, "rolled_back")


def test_types_are_reloaded_once_no_controller_is_loaded(spring):
    with pytest.raises(ApiError, match="while controllers are loaded: ") as caught:
        spring.reload_controller_types()
    assert caught.value.status == 409

    assert spring.reload_controller_types(force_kill=True) == ["spring"]
    assert spring.controllers() == []
    assert spring.reload_controller_types() == []


def test_an_unknown_parameter_is_refused_with_the_nearest_or_told(operator):
    picky = {
        "name": "picky",
        "type": "tests.api.spring:PickySpring",
        "params": {"joint": "j", "k": 2.0, "jiont": "j"},
    }
    refused = operator.post("/api/v1/controllers", json=picky)
    problem = problem_of(refused, 422, "invalid_parameter")
    assert "'jiont'. Did you mean 'joint'" in problem["detail"]
    assert names(operator) == {}

    told = operator.post("/api/v1/controllers", json=picky | {"unknown_params": "tell"})
    assert told.status_code == 201
    (note,) = told.json()["notes"]
    assert "'jiont' is unknown and has no effect" in note
    listed = operator.get("/api/v1/controllers").json()["controllers"]
    assert listed[0]["notes"] == [note]
