"""The shape of joint states."""

from station.core.control.joint_states import JointStates


def test_the_fields_are_those_of_the_message():
    assert JointStates._fields == ("stamp", "name", "position", "velocity", "effort")
