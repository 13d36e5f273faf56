"""PIDs around positions and velocities, and position errors of all kinds of joints."""

from math import isnan, pi

import pytest

from station.controllers import effort_controllers, velocity_controllers
from station.controllers.effort_controllers import (
    JointGroupPositionController,
    JointVelocityController,
)
from station.controllers.set_point_controller import set_wrapping
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.errors import RobotDescriptionError
from station.core.numerics.joint_errors import JointErrors
from station.memory.doubles import doubles, zeros

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


@pytest.mark.parametrize("joint_type", JointType)
def test_an_unknown_position_has_no_error(joint_type):
    joint = JointDescription("j", joint_type)
    assert isnan(position_error(joint, float("nan"), 0.0))


def position_error(joint, measured, set_point):
    """Return the error of the position of one joint."""
    errors = zeros(1)
    comparison = JointErrors(doubles([set_point]), doubles([measured]), errors)
    set_wrapping(comparison, [joint])
    comparison.compare()
    return errors[0]


@single_joint
def test_a_position_pid_rests_and_then_pulls_towards_the_set_point(
    robot, send, package, commanded
):
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
def test_a_position_pid_needs_a_robot_description(make_robot, package):
    with pytest.raises(RobotDescriptionError, match="robot_description"):
        make_robot(urdf="").load(
            package.JointPositionController, joint="elbow", pid={"p": 1.0}
        )


@single_joint
def test_the_derivative_gain_acts_on_the_difference_to_a_given_velocity(
    robot, package, commanded
):
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
    assert not controller._active.has_rates


def _start(robot):
    return robot.start(JointVelocityController, joint="elbow", pid={"p": 5.0})


def test_a_velocity_pid_starts_at_rest(robot):
    controller = _start(robot)
    robot.step(controller)
    assert robot.efforts_commanded == [0.0, 0.0, 0.0]


def test_the_error_of_a_velocity_pid_is_the_missing_velocity(robot, send):
    controller = _start(robot)
    robot.velocity[1] = 0.4
    send(controller, [1.0])
    robot.step(controller)
    assert robot.efforts_commanded[1] == pytest.approx(3.0)
    assert controller.sample.desired == [1.0]
    assert controller.sample.actual == [0.4]
    assert controller.sample.error == pytest.approx([0.6])
    assert controller.sample.output == pytest.approx([3.0])


def test_gains_of_a_velocity_pid_change_by_name(robot, send):
    controller = _start(robot)
    changed = controller.tunables.values | {"elbow/p": 7.0}
    controller.tunables.apply(controller.tunables.checked(changed))
    send(controller, [1.0])
    robot.step(controller)
    assert robot.efforts_commanded[1] == pytest.approx(7.0)
    assert controller.tunables.schema["elbow/p"].unit == "Nm s/rad"


def test_a_single_joint_publishes_the_state_message_of_the_original(robot, send):
    controller = robot.start(
        JointVelocityController,
        joint="elbow",
        pid={"p": 5.0, "i": 1.0, "d": 0.5, "i_clamp": 2.0, "antiwindup": True},
    )
    assert controller.published() == {}
    robot.velocity[1] = 0.4
    send(controller, [1.0])
    robot.step(controller)
    state = controller.published()["state"]
    assert state == {
        "stamp": robot.time,
        "time_step": 0.001,
        "set_point": 1.0,
        "process_value": 0.4,
        "error": pytest.approx(0.6),
        "command": controller.sample.output[0],
        "p": 5.0,
        "i": 1.0,
        "d": 0.5,
        "i_clamp": 2.0,
        "antiwindup": True,
    }


def test_a_group_publishes_a_state_with_one_number_per_joint(robot):
    controller = robot.start(
        JointGroupPositionController,
        joints=["slide", "elbow"],
        gains={"slide": {"p": 5.0}, "elbow": {"p": 7.0}},
    )
    robot.step(controller)
    state = controller.published()["state"]
    assert state["joint_names"] == ["slide", "elbow"]
    assert state["p"] == [5.0, 7.0]
    assert state["set_point"] == state["process_value"] == [0.0, 0.0]
