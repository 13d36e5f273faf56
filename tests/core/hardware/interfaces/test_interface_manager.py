"""Interfaces by type, also over several managers (CM-100, CM-101, CM-107, CM-108)."""

import pytest

from station.core.hardware.interfaces import (
    EffortJointInterface,
    InterfaceManager,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    VelocityJointInterface,
    interface_type_name,
)
from station.core.hardware.robot_hw import RobotHW


class Gripper:
    """Any object can be an interface."""


class Talking(RobotHW):
    """A robot that is an interface itself."""

    def __init__(self):
        super().__init__()
        self.register_interface(self)


def efforts(*names):
    interface = EffortJointInterface()
    for name in names:
        state = JointStateHandle(name, [0.0], [0.0], [0.0])
        interface.register_handle(JointHandle(state, [0.0]))
    return interface


def manager_with(*interfaces):
    manager = InterfaceManager()
    for interface in interfaces:
        manager.register_interface(interface)
    return manager


@pytest.fixture
def pair():
    """Two managers with one effort joint each, combined."""
    first, second = manager_with(efforts("a")), manager_with(efforts("b"))
    combined = InterfaceManager()
    combined.register_interface_manager(first)
    combined.register_interface_manager(second)
    return combined


def test_an_interface_is_found_by_its_type():
    interface = efforts("a")

    manager = manager_with(interface)

    assert manager.get(EffortJointInterface) is interface
    assert manager.get(VelocityJointInterface) is None


def test_registering_a_type_again_replaces_it():
    second = efforts("b")

    assert manager_with(efforts("a"), second).get(EffortJointInterface) is second


def test_any_object_can_be_an_interface():
    gripper = Gripper()

    assert manager_with(gripper).get(Gripper) is gripper


def test_an_interface_can_be_registered_under_another_type():
    manager, gripper = InterfaceManager(), Gripper()

    manager.register_interface(gripper, object)

    assert manager.get(object) is gripper
    assert manager.get(Gripper) is None


def test_a_robot_can_be_its_own_interface():
    robot = Talking()

    assert robot.get(Talking) is robot


def test_names_on_the_wire():
    assert interface_type_name(EffortJointInterface) == (
        "hardware_interface::EffortJointInterface"
    )
    assert interface_type_name(Gripper).endswith("Gripper")


def test_one_provider_gives_the_very_interface():
    interface = efforts("a")
    combined = InterfaceManager()
    combined.register_interface_manager(manager_with(interface))

    assert combined.get(EffortJointInterface) is interface


def test_several_providers_give_one_interface_with_all_handles(pair):
    combined = pair.get(EffortJointInterface)

    assert combined.get_names() == ["a", "b"]


def test_combined_handles_are_the_providers_own():
    first = efforts("a")
    combined = InterfaceManager()
    combined.register_interface_manager(manager_with(first))
    combined.register_interface_manager(manager_with(efforts("b")))

    combined.get(EffortJointInterface).get_handle("a").set_command(2.0)

    assert first.get_handle("a").get_command() == 2.0


def test_the_combination_is_kept_until_a_provider_joins(pair):
    before = pair.get(EffortJointInterface)
    assert pair.get(EffortJointInterface) is before

    pair.register_interface_manager(manager_with(efforts("c")))

    assert pair.get(EffortJointInterface).get_names() == ["a", "b", "c"]


def test_own_interfaces_are_combined_with_those_of_managers(pair):
    pair.register_interface(efforts("z"))

    assert pair.get(EffortJointInterface).get_names() == ["a", "b", "z"]


def test_objects_that_hold_no_resources_cannot_be_combined():
    combined = manager_with(Gripper())
    combined.register_interface_manager(manager_with(Gripper()))

    assert combined.get(Gripper) is None


def test_types_are_listed_once_and_resources_of_all_providers(pair):
    effort = interface_type_name(EffortJointInterface)
    pair.register_interface(JointStateInterface())

    assert sorted(pair.get_names()) == [
        effort,
        interface_type_name(JointStateInterface),
    ]
    assert pair.get_interface_resources(effort) == ["a", "b"]
    assert pair.get_interface_resources("nothing") == []


def test_objects_without_resources_have_none_to_list():
    manager = manager_with(Gripper())

    assert manager.get_interface_resources(interface_type_name(Gripper)) == []
