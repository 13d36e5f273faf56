"""A service that a robot declares reaches the API, both clients and the shell."""

import asyncio
import json

import httpx
import pytest

from station import wire
from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.service_routes import request_model, services_of
from station.cli import main
from station.client import ApiError, AsyncStationClient
from station.core.errors import HardwareInterfaceError
from station.core.franka import FrankaServices
from tests.api.conftest import OPERATOR, URL
from tests.franka_station import make_franka_station
from tests.swing_station import SwingServices, make_swing_station

# The model that a client sends for each service of an arm.
MODELS = {
    "contact_budget": None,
    "set_joint_impedance": wire.JointImpedance,
    "set_cartesian_impedance": wire.CartesianImpedance,
    "set_EE_frame": wire.EndEffectorFrame,
    "set_K_frame": wire.StiffnessFrame,
    "set_load": wire.Load,
    "connect": None,
    "disconnect": None,
}


@pytest.fixture
def station():
    return make_swing_station()


@pytest.fixture
def swing(client):
    return client.robot("swing")


def test_services_are_listed(swing):
    services = {service.name: service for service in swing.services()}

    assert services["set_lengths"] == wire.ServiceInfo(
        name="set_lengths",
        method="PUT",
        path="lengths",
        description="Set the lengths of the ropes.",
        parameters=["lengths"],
    )
    assert [services[name].method for name in ("push", "length")] == ["POST", "GET"]


def test_services_are_called_by_the_blocking_client(swing):
    assert swing.call("set_lengths", lengths=[1.0, 2.5]) is None
    assert swing.call("length") == 2.5
    assert swing.call("push", impulse=2.0, gently=True)["pushes"] == 1.0


def test_services_are_called_by_the_client_for_asyncio(app, station):
    async def push():
        transport = httpx.ASGITransport(app)
        async with AsyncStationClient(URL, OPERATOR, transport=transport) as client:
            return await client.robot("swing").call("push", impulse=2.0)

    assert asyncio.run(push()) == {"impulse": 2.0, "pushes": 1.0}
    assert station.loop.hw.swing.pushes == [(2.0, False)]


def test_services_are_called_from_the_command_line(server, capsys):
    where = ["--url", server.url, "--token", OPERATOR]

    assert main(["robot", "swing", "set-lengths", "lengths=[1.5]", *where]) == 0
    assert capsys.readouterr().out == "Done.\n"
    assert main(["robot", "swing", "length", "--json", *where]) == 0
    assert json.loads(capsys.readouterr().out) == 1.5
    assert main(["robot", "swing", *where]) == 0
    assert "push         impulse, gently  Push the swing." in capsys.readouterr().out


def test_services_stand_in_the_openapi_document(app):
    document = app.openapi()

    path = document["paths"]["/api/v1/robots/{arm_id}/push"]["post"]
    assert path["description"].startswith("Push the swing.\n\nIt does not wait")
    assert "423" in path["responses"]
    model = document["components"]["schemas"]["PushRequest"]
    assert model["required"] == ["impulse"]
    assert model["additionalProperties"] is False


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ({"impulse": "2.0"}, "body/impulse"),
        ({}, "body/impulse"),
        ({"impulse": 2.0, "hard": True}, "body/hard"),
    ],
)
def test_arguments_are_checked_as_strictly_as_any_request(swing, arguments, problem):
    with pytest.raises(ApiError, match=problem) as caught:
        swing.call("push", **arguments)
    assert caught.value.status == 422


def test_a_refusal_of_a_service_reaches_the_client(swing):
    with pytest.raises(ApiError, match="A length is 0") as caught:
        swing.call("set_lengths", lengths=[0.0])
    assert (caught.value.status, caught.value.code) == (422, "invalid_command")


def test_a_service_that_is_unknown_or_of_another_robot_is_not_found(client, swing):
    with pytest.raises(ApiError, match="no service 'jump'") as caught:
        swing.call("jump")
    assert (caught.value.code, caught.value.status) == ("service_not_found", 404)
    with pytest.raises(ApiError, match="no service 'set_load'") as caught:
        client.robot("swing").set_load(
            wire.Load(mass=0.0, F_x_center_load=[0.0] * 3, load_inertia=[0.0] * 9)
        )
    assert (caught.value.code, caught.value.status) == ("service_not_found", 404)


def test_a_viewer_may_ask_but_not_change(http, authenticator):
    http.headers["Authorization"] = f"Bearer {authenticator.viewer_token}"
    route = "/api/v1/robots/swing"

    assert http.get(f"{route}/length").json() == 1.0
    assert http.put(f"{route}/lengths", json={"lengths": [2.0]}).status_code == 403


def test_a_service_that_moves_is_refused_while_stopped(swing, station):
    station.stop("test")
    station.loop.step()

    with pytest.raises(ApiError) as caught:
        swing.call("push", impulse=1.0)
    assert caught.value.status == 423


@pytest.mark.parametrize("taken", [{"push"}, {"length", "push"}])
def test_two_services_of_one_path_are_refused(taken):
    with pytest.raises(HardwareInterfaceError, match="has the path 'push'"):
        services_of([SwingServices], taken)


def test_a_service_may_not_hide_a_route_of_the_station():
    station = make_swing_station()
    station.loop.hw.swing.__class__ = type("Wrong", (SwingServices,), {})
    swing = type(station.loop.hw.swing)
    swing.state = SwingServices.push

    with pytest.raises(HardwareInterfaceError, match="path 'state', which is taken"):
        create_app(station, Authenticator())


def test_the_wire_models_have_the_parameters_of_the_arm_s_services():
    assert set(MODELS) == set(FrankaServices.services())
    for name, service in FrankaServices.services().items():
        model = MODELS[name]
        fields = [] if model is None else list(model.model_fields)
        assert fields == list(service.parameters), name
        assert (request_model(service) is None) == (model is None)


def test_services_of_an_arm_can_be_called_by_name():
    station = make_franka_station()
    app = create_app(station, Authenticator(OPERATOR))

    async def call():
        transport = httpx.ASGITransport(app)
        async with AsyncStationClient(URL, OPERATOR, transport=transport) as client:
            stiffness = [100.0] * 7
            return await client.robot("panda").call(
                "set_joint_impedance", joint_stiffness=stiffness
            )

    assert asyncio.run(call())["robot_mode"] == "idle"
