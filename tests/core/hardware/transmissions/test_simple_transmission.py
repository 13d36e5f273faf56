"""One actuator and one joint, by hand."""

from station.core.hardware.transmissions import SimpleTransmission


def test_reduction_slows_the_joint_and_multiplies_its_effort():
    transmission = SimpleTransmission(50.0, joint_offset=0.5)
    assert transmission.actuator_to_joint_position([100.0]) == [2.5]
    assert transmission.actuator_to_joint_velocity([-50.0]) == [-1.0]
    assert transmission.actuator_to_joint_effort([2.0]) == [100.0]


def test_negative_reduction_turns_the_joint_the_other_way():
    transmission = SimpleTransmission(-2.0)
    assert transmission.joint_to_actuator_position([3.0]) == [-6.0]
    assert transmission.joint_to_actuator_effort([4.0]) == [-2.0]


def test_sensors_are_mapped_like_position_and_effort():
    transmission = SimpleTransmission(4.0, joint_offset=1.0)
    assert transmission.actuator_to_joint_absolute_position([8.0]) == [3.0]
    assert transmission.actuator_to_joint_torque_sensor([2.0]) == [8.0]
