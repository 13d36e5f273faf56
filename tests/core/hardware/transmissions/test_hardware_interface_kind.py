"""Each name stands for matching interfaces of joints and actuators."""

import pytest

from station.core.hardware.interfaces import JointStateInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.transmissions.transmission_interface_loader import (
    HARDWARE_INTERFACES,
    interface_of,
)


@pytest.mark.parametrize("quantity", ["position", "velocity", "effort"])
@pytest.mark.parametrize("prefix", ["", "BiDirectional"])
def test_joint_and_actuator_interface_have_the_same_quantity(quantity, prefix):
    name = f"hardware_interface/{prefix}{quantity.title()}JointInterface"
    kind, is_bidirectional = HARDWARE_INTERFACES[name]
    assert is_bidirectional is bool(prefix)
    assert kind.quantity == quantity
    assert kind.joint_interface.__name__ == f"{quantity.title()}JointInterface"
    assert kind.actuator_interface.__name__ == f"{quantity.title()}ActuatorInterface"


def test_state_alone_has_no_command():
    kind = HARDWARE_INTERFACES["hardware_interface/JointStateInterface"]
    assert kind == (None, False)


def test_interface_is_made_once():
    robot = RobotHW()
    first = interface_of(robot, JointStateInterface)
    assert interface_of(robot, JointStateInterface) is first
    assert robot.get(JointStateInterface) is first
