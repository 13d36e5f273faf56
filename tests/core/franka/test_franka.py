"""Services, states and simulations of an arm or a hand: their contracts."""

import pytest

from station.core.errors import ResourceNotFoundError
from station.core.franka import (
    ArmSimulation,
    FrankaServices,
    FrankaServicesInterface,
    FrankaStateHandle,
    FrankaStateInterface,
    GripperServices,
    RobotState,
)


@pytest.mark.parametrize(
    ("base", "forgotten"),
    [
        (FrankaServices, "set_load"),
        (FrankaServices, "set_EE_frame"),
        (FrankaServices, "simulation"),
        (GripperServices, "grasp"),
        (GripperServices, "stop"),
        (ArmSimulation, "clear_faults"),
    ],
)
def test_class_that_forgets_an_operation_cannot_be_constructed(base, forgotten):
    names = base.__abstractmethods__ - {forgotten}
    operations = {name: lambda *_: None for name in names}

    with pytest.raises(TypeError, match=forgotten):
        type("Incomplete", (base,), operations)()


OPERATIONS = {name: lambda *_: None for name in FrankaServices.__abstractmethods__}


def test_services_are_found_by_arm_and_claim_nothing():
    interface = FrankaServicesInterface()
    interface.register_handle(type("Services", (FrankaServices,), OPERATIONS)("left"))

    assert interface.get_handle("left").name == "left"
    assert interface.get_claims() == []
    with pytest.raises(ResourceNotFoundError, match="resource 'right'"):
        interface.get_handle("right")


def test_state_is_refreshed_when_asked_for():
    state, asked = RobotState(), []
    interface = FrankaStateInterface()
    interface.register_handle(
        FrankaStateHandle("a_robot", state, lambda: asked.append(1))
    )

    handle = interface.get_handle("a_robot")

    assert handle.get_robot_state() is state
    assert asked == [1]
    assert interface.get_claims() == []
    assert handle.command_slots() == []
