"""The tree of parameters, read and changed while the station runs."""

import threading

import pytest

from station.core.errors import (
    ControllerExistsError,
    ParameterError,
    ParameterNotFoundError,
)
from station.core.facade.station import Station
from tests.two_joint_station import make_station


@pytest.fixture
def station() -> Station:
    return make_station()


@pytest.fixture
def server(station):
    return station.parameter_server


def test_the_whole_tree_is_read_without_a_path(server):
    assert set(server.get()) >= {"arm", "group", "robot_description"}
    assert server.get("/arm/joints/") == ["j1", "j2"]


def test_an_unknown_path_gets_the_nearest_beside_it(server):
    with pytest.raises(ParameterNotFoundError, match="'arm/joint'") as caught:
        server.get("arm/joint")
    assert "'joints'" in caught.value.remedy


def test_what_is_set_is_what_a_controller_is_loaded_with(station, server):
    server.set("other/type", "position_controllers/JointGroupPositionController")
    server.set("other/joints", ["j2"])

    station.load_controller("other")

    assert station.manager.get_controller("other").joint_names == ["j2"]


def test_what_was_read_cannot_be_changed_through_its_value(server):
    server.get("arm")["joints"].append("j3")

    assert server.get("arm/joints") == ["j1", "j2"]


def test_a_value_is_no_namespace(server):
    server.set("a/b", 5)
    with pytest.raises(ParameterError, match="'a/b' has a value"):
        server.set("a/b/c/d", 1)
    assert server.get("a") == {"b": 5}


def test_a_namespace_is_deleted_whole(server):
    server.set("a", {"b": {"c": 1}})

    assert server.delete("a") == {"b": {"c": 1}}
    with pytest.raises(ParameterNotFoundError):
        server.delete("a")


@pytest.mark.parametrize("path", ["", "/", "robot", "robot/arm_id"])
def test_the_root_and_the_robot_are_not_changed(path):
    station = make_station()
    server = type(station.parameter_server)(
        station.parameters, threading.Lock(), lambda _: False, {"robot"}
    )

    with pytest.raises(ParameterError, match="while the station runs"):
        server.set(path, {})
    with pytest.raises(ParameterError, match="while the station runs"):
        server.delete(path)


def test_parameters_that_are_being_read_are_not_changed(station, server):
    announced = station.manager.announce("slow")
    with announced, pytest.raises(ControllerExistsError, match="being loaded"):
        server.set("slow/p", 1)
