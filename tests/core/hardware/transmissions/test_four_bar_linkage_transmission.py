"""Two actuators and two joints on a four-bar linkage, by hand."""

from station.core.hardware.transmissions import FourBarLinkageTransmission

LEG = FourBarLinkageTransmission([10.0, 5.0], [2.0, 4.0], [0.5, -0.5])


def test_first_actuator_moves_the_second_joint_back():
    assert LEG.actuator_to_joint_velocity([20.0, 0.0]) == [1.0, -0.25]


def test_second_actuator_moves_only_the_second_joint():
    assert LEG.actuator_to_joint_velocity([0.0, 20.0]) == [0.0, 1.0]


def test_offsets_are_added_to_positions():
    assert LEG.actuator_to_joint_position([0.0, 0.0]) == [0.5, -0.5]
    assert LEG.joint_to_actuator_position([0.5, -0.5]) == [0.0, 0.0]


def test_efforts_follow_the_documented_formulas():
    assert LEG.actuator_to_joint_effort([1.0, 3.0]) == [20.0, -20.0]
    assert LEG.joint_to_actuator_effort([20.0, -20.0]) == [1.0, 3.0]
