"""Position errors of all kinds of joints, and the single-joint controllers."""

from math import isnan, pi

import pytest

from station.controllers import effort_controllers, velocity_controllers
from station.controllers.pid_command_controller import position_error
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.errors import RobotDescriptionError

single_joint = pytest.mark.parametrize(
    ("package", "commanded"),
    [
        (effort_controllers, "efforts_commanded"),
        (velocity_controllers, "velocities_commanded"),
    ],
)


@pytest.mark.parametrize(
    ("joint_type", "measured", "set_point", "error"),
    [
        (JointType.CONTINUOUS, 3.0, -3.0, 2 * pi - 6.0),
        (JointType.CONTINUOUS, 0.0, 20.0, 20.0 - 6 * pi),
        (JointType.REVOLUTE, -2.8, 2.8, 5.6),
        (JointType.REVOLUTE, 2.9, -2.9, -5.8),
        (JointType.PRISMATIC, -4.0, 4.0, 8.0),
    ],
)
def test_the_error_is_the_way_the_joint_can_go(joint_type, measured, set_point, error):
    joint = JointDescription("j", joint_type, -2.9, 2.9)
    assert position_error(joint, measured, set_point) == pytest.approx(error)


def test_an_unknown_position_has_no_error():
    assert isnan(position_error(JointDescription("j"), float("nan"), 0.0))


@single_joint
def test_it_rests_and_then_pulls_towards_the_set_point(robot, send, package, commanded):
    robot.position[1] = 0.4
    controller = robot.start(
        package.JointPositionController, joint="elbow", pid={"p": 10.0, "d": 0.0}
    )
    robot.step(controller)
    assert getattr(robot, commanded) == [0.0, 0.0, 0.0]
    send(controller, [0.6])
    robot.step(controller)
    assert getattr(robot, commanded)[1] == pytest.approx(2.0)


@pytest.mark.parametrize("package", [effort_controllers, velocity_controllers])
def test_it_needs_a_robot_description(make_robot, package):
    with pytest.raises(RobotDescriptionError, match="robot_description"):
        make_robot(urdf="").load(
            package.JointPositionController, joint="elbow", pid={"p": 1.0}
        )


@single_joint
def test_a_velocity_is_fed_forward(robot, package, commanded):
    controller = robot.start(
        package.JointPositionController, joint="elbow", pid={"p": 10.0, "d": 2.0}
    )
    robot.velocity[1] = 0.5
    controller.set_points.post([0.1, 1.5])
    robot.step(controller)
    # p of 10 times 0.1 rad, d of 2 times the missing 1 rad/s
    assert getattr(robot, commanded)[1] == pytest.approx(3.0)

    robot.velocity[1] = 0.0
    controller.set_points.clear()
    robot.step(controller)
    assert controller.rates == []
