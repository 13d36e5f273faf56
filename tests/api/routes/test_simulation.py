"""Pause, step and reset over HTTP."""

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.client import ApiError, StationClient
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.api.spring import make_station as make_spring_station
from tests.api.test_errors import problem_of
from tests.two_joint_station import make_station

SIMULATION = "/api/v1/simulation"


@pytest.fixture
def station():
    """Return a station over a simulated robot."""
    return make_station()


@pytest.fixture
def client(station):
    """Return an operator's client of it."""
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with StationClient(URL, OPERATOR, transport=AppTransport(app)) as client:
        yield client


def test_pause_step_and_resume(client, station):
    assert client.simulation.state().paused is False
    assert client.simulation.pause().paused is True

    client.simulation.step(5)

    assert station.loop.cycle == 5
    assert client.simulation.resume().paused is False


def test_a_reset_says_where_the_joints_go(client, station):
    client.switch_controllers(start=["group"])
    epoch = client.status().epoch

    report = client.simulation.reset({"j1": 0.5})
    station.loop.step(3)

    assert report.time == 0.0
    assert client.joint_states().position == [0.5, 0.0]
    assert client.status().epoch == epoch + 1


def test_the_status_says_that_time_stands_still(client):
    assert client.status().simulation.paused is False

    client.simulation.pause()

    assert client.status().simulation.paused is True


@pytest.mark.parametrize(
    ("path", "method", "body", "status", "code"),
    [
        ("", "PATCH", {"real_time_factor": 0.0}, 422, "invalid_parameter"),
        ("", "PATCH", {"real_time_factor": 1e-6}, 422, "invalid_parameter"),
        ("", "PATCH", {"real_time_factor": 1e-308}, 422, "invalid_parameter"),
        ("", "PATCH", {"real_time_factor": 101.0}, 422, "invalid_parameter"),
        ("", "PATCH", {"paused": "yes"}, 422, "invalid_request"),
        ("/step", "POST", {"n": 0}, 422, "invalid_parameter"),
        ("/step", "POST", {"n": 3}, 409, "simulation_refused"),
        ("/reset", "POST", {"joint_positions": {"j9": 0}}, 422, "invalid_parameter"),
        ("/reset", "POST", {"keyframe": 3}, 422, "invalid_request"),
    ],
)
def test_impossible_changes_of_the_simulation_are_refused(
    operator, path, method, body, status, code
):
    problem_of(operator.request(method, SIMULATION + path, json=body), status, code)


def test_a_real_robot_refuses_the_routes_of_the_simulation():
    app = create_app(make_spring_station(), Authenticator(OPERATOR, VIEWER))
    with (
        StationClient(URL, VIEWER, transport=AppTransport(app)) as client,
        pytest.raises(ApiError, match="OneJointHW is not simulated") as refused,
    ):
        client.simulation.state()

    assert (refused.value.status, refused.value.code) == (409, "simulation_refused")


def test_a_viewer_may_look_only(station):
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with StationClient(URL, VIEWER, transport=AppTransport(app)) as client:
        assert client.simulation.state().time == 0.0
        with pytest.raises(ApiError) as refused:
            client.simulation.pause()

    assert refused.value.status == 403


def test_a_keyframe_that_is_not_there_is_refused(client):
    with pytest.raises(ApiError, match="no keyframe 'ready'") as caught:
        client.simulation.reset(keyframe="ready")
    assert caught.value.status == 422
