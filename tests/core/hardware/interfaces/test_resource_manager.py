"""Handles by name, and what asking for them claims."""

import pytest

from station.core.errors import HardwareInterfaceError, ResourceNotFoundError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    HardwareResourceManager,
    InterfaceManager,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    ResourceHandle,
    ResourceManager,
    VelocityJointInterface,
    interface_type_name,
)
from station.core.hardware.interfaces.resource_manager import check_storage
from station.core.hardware.robot_hw import RobotHW


class Claiming(HardwareResourceManager[ResourceHandle]):
    """Claims what is asked for."""

    claims_resources = True


class Reading(HardwareResourceManager[ResourceHandle]):
    """Claims nothing."""


class Resting(Claiming):
    """Its resources rest at 7."""

    def rest_commands(self, name):
        return [7.0]


def filled(manager, *names):
    for name in names:
        manager.register_handle(ResourceHandle(name))
    return manager


def test_names_are_sorted():
    assert filled(ResourceManager(), "b", "a").get_names() == ["a", "b"]


def test_handles_keep_the_order_of_registration():
    names = [handle.name for handle in filled(ResourceManager(), "b", "a").handles()]

    assert names == ["b", "a"]


def test_a_handle_of_the_same_name_replaces_the_first():
    manager = filled(ResourceManager(), "a")
    second = ResourceHandle("a")

    manager.register_handle(second)

    assert manager.get_handle("a") is second
    assert manager.get_names() == ["a"]


def test_an_unknown_name_is_refused_in_the_words_of_the_original():
    interface = EffortJointInterface()

    with pytest.raises(ResourceNotFoundError) as caught:
        interface.get_handle("x")

    assert str(caught.value) == (
        "Could not find resource 'x' in 'hardware_interface::EffortJointInterface'."
    )


def test_asking_for_a_handle_claims_it_once():
    manager = filled(Claiming(), "b", "a", "c")

    for name in ("b", "a", "b"):
        manager.get_handle(name)

    assert manager.get_claims() == ["a", "b"]


def test_asking_for_an_unknown_handle_claims_nothing():
    manager = Claiming()

    with pytest.raises(ResourceNotFoundError):
        manager.get_handle("x")

    assert manager.get_claims() == []


def test_claims_can_be_forgotten():
    manager = filled(Claiming(), "a")
    manager.get_handle("a")

    manager.clear_claims()

    assert manager.get_claims() == []


def test_reading_claims_nothing():
    manager = filled(Reading(), "a")

    manager.get_handle("a")

    assert manager.get_claims() == []


def test_a_resource_can_be_claimed_without_its_handle():
    manager = filled(Claiming(), "a")

    manager.claim("a")

    assert manager.get_claims() == ["a"]


def test_which_interfaces_claim():
    assert EffortJointInterface.claims_resources
    assert not JointStateInterface.claims_resources


@pytest.mark.parametrize(
    ("storage", "index", "words"),
    [(None, 0, "is null"), ([0.0], 1, "index 1"), ([0.0], -1, "index -1")],
)
def test_storage_without_the_slot_is_refused(storage, index, words):
    with pytest.raises(HardwareInterfaceError, match=words):
        check_storage("j", "Position", storage, index)


def test_handles_without_commands_rest_with_none():
    assert filled(Claiming(), "a").rest_commands("a") == []


def test_commands_rest_at_zero_and_may_begin_anywhere_by_default():
    class Plain(HardwareResourceManager[JointHandle]):
        """Joint handles, and no word about rest."""

    manager = Plain()
    state = JointStateHandle("j", [1.0], [0.0], [0.0])
    manager.register_handle(JointHandle(state, [3.0]))

    assert manager.rest_commands("j") == [0.0]
    assert manager.start_jump_limits("j") == [float("inf")]


def test_a_combined_interface_knows_where_its_handles_come_from():
    first, second = filled(Claiming(), "a"), filled(Resting(), "b")
    combined, twice = Claiming(), Claiming()
    combined.merge([first, second])
    twice.merge([combined])

    assert combined.origin("a") is first
    assert combined.origin("b").rest_commands("b") == [7.0]
    assert twice.origin("b") is second
    assert first.origin("a") is first


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
