"""Two actuators and two joints on a differential, by hand."""

import pytest

from station.core.hardware.transmissions import (
    DifferentialTransmission,
    TransmissionInterfaceError,
)

WRIST = DifferentialTransmission([10.0, 10.0], [1.0, 2.0], [0.5, -0.5])


def test_equal_motion_turns_only_the_first_joint():
    assert WRIST.actuator_to_joint_velocity([20.0, 20.0]) == [2.0, 0.0]


def test_opposite_motion_turns_only_the_second_joint():
    assert WRIST.actuator_to_joint_velocity([20.0, -20.0]) == [0.0, 1.0]


def test_offsets_are_added_to_positions():
    assert WRIST.actuator_to_joint_position([0.0, 0.0]) == [0.5, -0.5]
    assert WRIST.joint_to_actuator_position([0.5, -0.5]) == [0.0, 0.0]


def test_both_actuators_bear_the_effort_of_one_joint():
    assert WRIST.joint_to_actuator_effort([40.0, 0.0]) == [2.0, 2.0]
    assert WRIST.joint_to_actuator_effort([0.0, 40.0]) == [1.0, -1.0]


def test_encoders_on_the_joints_are_exchanged_and_nothing_else():
    transmission = DifferentialTransmission(
        [10.0, 10.0], [1.0, 1.0], ignore_transmission_for_absolute_encoders=True
    )
    assert transmission.actuator_to_joint_absolute_position([1.0, 2.0]) == [2.0, 1.0]


@pytest.mark.parametrize("sizes", [(1, 2, 2), (2, 3, 2), (2, 2, 0)])
def test_other_than_two_values_are_refused(sizes):
    with pytest.raises(
        TransmissionInterfaceError, match="a differential transmission must have size 2"
    ):
        DifferentialTransmission(*([1.0] * size for size in sizes))
