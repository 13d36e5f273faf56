"""Handles by name, and what asking for them claims."""

import pytest

from station.core.errors import HardwareInterfaceError, ResourceNotFoundError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    HardwareResourceManager,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    ResourceHandle,
    ResourceManager,
)
from station.core.hardware.interfaces.resource_manager import check_storage


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
