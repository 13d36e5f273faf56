"""Transmissions of two actuators and two joints treat positions and offsets alike."""

import pytest

from station.core.hardware.transmissions import (
    DifferentialTransmission,
    FourBarLinkageTransmission,
    TransmissionInterfaceError,
)

KINDS = {
    "differential": DifferentialTransmission,
    "four-bar linkage": FourBarLinkageTransmission,
}


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_positions_are_mapped_like_velocities_with_offsets(kind):
    maps = kind([2.0, 4.0], [1.0, 0.5], [0.25, -0.5])
    velocity = maps.actuator_to_joint_velocity([8.0, -4.0])

    position = maps.actuator_to_joint_position([8.0, -4.0])

    assert position == [velocity[0] + 0.25, velocity[1] - 0.5]
    assert maps.joint_to_actuator_position(position) == [8.0, -4.0]


@pytest.mark.parametrize("name", KINDS)
def test_lists_of_another_size_are_refused_with_the_kind_and_the_sizes(name):
    with pytest.raises(TransmissionInterfaceError, match=f"of a {name} trans") as error:
        KINDS[name]([1.0], [1.0, 1.0], [0.0, 0.0])
    assert "1 actuator reductions, 2 joint reductions" in error.value.remedy
