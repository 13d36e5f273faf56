"""The robot over HTTP."""

import pytest

from station.client.errors import ApiError


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
