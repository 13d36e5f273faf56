"""The tree of parameters over HTTP."""

import pytest

from station.client import ApiError
from tests.api.test_errors import problem_of

PARAMETERS = "/api/v1/parameters"


def test_parameters_are_set_read_and_deleted(client):
    client.set_parameter("arm/gains/j 1", {"p": 5.0})

    assert client.parameter("arm/gains/j 1/p") == 5.0
    assert client.parameter()["arm"] == {"gains": {"j 1": {"p": 5.0}}}
    assert client.delete_parameter("arm") == {"gains": {"j 1": {"p": 5.0}}}
    assert "arm" not in client.parameter()


def test_a_controller_is_loaded_with_what_was_set(client, station):
    client.set_parameter("spring", {"type": "test/Spring", "joint": "j", "k": 4.0})

    client.load_controller("spring")

    assert station.tuning.gains("spring").values == {"k": 4.0}


def test_an_unknown_parameter_is_404(client):
    with pytest.raises(ApiError, match="no parameter 'nothing'") as caught:
        client.parameter("nothing")
    assert caught.value.status == 404


def test_what_is_not_there_or_being_read_is_not_deleted(operator, station):
    problem_of(operator.delete(f"{PARAMETERS}/nothing"), 404, "parameter_not_found")
    with station.manager.announce("slow"):
        problem_of(operator.delete(f"{PARAMETERS}/slow/p"), 409, "controller_exists")
        put = operator.put(f"{PARAMETERS}/slow/p", json={"value": 1})
        problem_of(put, 409, "controller_exists")


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("", '{"value": 1}'),
        ("/a", "{}"),
        ("/a", '{"value": NaN}'),
        ("/a", '{"value": 1, "more": 2}'),
        ("/a", '{"value": ' + "[" * 40 + "1" + "]" * 40 + "}"),
    ],
)
def test_a_malformed_request_changes_nothing(operator, station, path, body):
    before = station.parameter_server.get()
    answer = operator.put(
        PARAMETERS + path, content=body, headers={"Content-Type": "application/json"}
    )

    assert answer.status_code in {405, 422}
    assert station.parameter_server.get() == before


def test_a_viewer_reads_and_changes_nothing(http):
    http.headers["Authorization"] = "Bearer viewer-token"

    assert http.get(PARAMETERS).status_code == 200
    problem_of(http.put(f"{PARAMETERS}/a", json={"value": 1}), 403, "operator_needed")
    problem_of(http.delete(f"{PARAMETERS}/a"), 403, "operator_needed")
