"""The three forwarding controllers of one joint."""

import pytest

from station.controllers.effort_controllers import JointEffortController
from station.controllers.position_controllers import JointPositionController
from station.controllers.velocity_controllers import JointVelocityController
from station.core.errors import InvalidCommandError, ParameterError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
    VelocityJointInterface,
)

all_families = pytest.mark.parametrize(
    ("controller_class", "interface", "rest"),
    [
        (JointPositionController, PositionJointInterface, 0.4),
        (JointVelocityController, VelocityJointInterface, 0.0),
        (JointEffortController, EffortJointInterface, 0.0),
    ],
)


@all_families
def test_a_forwarding_controller_rests_and_then_forwards(
    robot, send, controller_class, interface, rest
):
    robot.position[1] = 0.4
    controller = robot.start(controller_class, joint="elbow")
    robot.step(controller)
    assert robot.commands[interface][1] == rest
    send(controller, [0.7])
    robot.step(controller)
    assert robot.commands[interface] == [0.0, 0.7, 0.0]


single_classes = pytest.mark.parametrize(
    "controller_class",
    [JointPositionController, JointVelocityController, JointEffortController],
)


@single_classes
def test_a_single_joint_controller_takes_one_number(robot, controller_class):
    controller = robot.load(controller_class, joint="elbow")
    assert controller.claims[0].resources == ("elbow",)
    with pytest.raises(InvalidCommandError, match="takes 1: elbow"):
        controller.set_points.check([0.0, 0.0])


@single_classes
@pytest.mark.parametrize("values", [{"joints": ["a"]}, {"joint": ["a"]}, {"joint": 3}])
def test_the_joint_of_a_single_joint_controller_must_be_a_name(
    robot, controller_class, values
):
    with pytest.raises(ParameterError, match="'arm/joint'"):
        robot.load(controller_class, **values)
