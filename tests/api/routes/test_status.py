"""The station at a glance."""

import pytest

from station.api.routes.status import versions
from station.client.errors import ApiError
from station.compiled import present_status
from station.core.control.controller_manager import ControllerManager
from station.wire import CommandViolations


def test_status(client, station):
    status = client.status()

    assert status.boot_id == station.boot_id
    assert status.cycle == 1
    assert status.stop_state == "armed"
    assert status.robot_type == "test/OneJointHW"
    assert status.loop.state == "stopped"
    assert status.versions["station"]


def test_status_says_which_kernel_runs_and_why(client):
    kernel = client.status().kernel

    assert (kernel.mode, kernel.reason) == (
        present_status().mode,
        present_status().reason,
    )


def test_a_package_that_is_missing_does_no_harm(monkeypatch):
    from importlib.metadata import PackageNotFoundError

    from station.api.routes import status

    def missing(name):
        raise PackageNotFoundError(name)

    versions.cache_clear()
    monkeypatch.setattr(status, "version", missing)
    assert versions()["mujoco"] == "not installed"
    versions.cache_clear()


def test_commands_that_nobody_had_the_right_to_write_are_told(client, monkeypatch):
    assert client.status().command_violations == CommandViolations(count=0, last="")
    violations = (2, "'arm' wrote 5.0 to 'j', which it has not claimed")
    monkeypatch.setattr(
        ControllerManager, "command_violations", property(lambda _: violations)
    )

    told = client.status().command_violations

    assert (told.count, told.last) == violations


def test_interfaces_and_claims(client):
    client.load_controller("spring", "test/Spring", {"joint": "j"})
    client.switch_controllers(start=["spring"])

    hardware = client.hardware()

    interfaces = {interface.name: interface for interface in hardware.interfaces}
    effort = interfaces["hardware_interface::EffortJointInterface"]
    assert [(r.name, r.claimed_by) for r in effort.resources] == [("j", ["spring"])]
    assert hardware.limits == []
    assert hardware.clamps == client.status().clamps == []


def test_a_component_is_brought_into_a_state_with_or_without_its_users(client):
    client.load_controller("spring", "test/Spring", {"joint": "j"})
    client.switch_controllers(start=["spring"])
    (component,) = client.hardware_components()
    assert (component.name, component.state) == ("robot", "active")
    (effort,) = component.command_interfaces
    assert (effort.resource, effort.claimed_by) == ("j", ["spring"])

    with pytest.raises(ApiError, match="in use by spring"):
        client.set_hardware_component_state("robot", "inactive")
    found = client.set_hardware_component_state(
        "robot", "inactive", stop_controllers=True
    )
    assert found.state == "inactive"
    assert not found.command_interfaces[0].is_available
    with pytest.raises(ApiError, match="'robot', which is inactive"):
        client.switch_controllers(start=["spring"])
    with pytest.raises(ApiError, match="'robbot'"):
        client.set_hardware_component_state("robbot", "active")
    client.set_hardware_component_state("robot", "active")
    assert client.switch_controllers(start=["spring"]).ok
