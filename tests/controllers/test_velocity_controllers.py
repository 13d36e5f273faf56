"""Controllers that command velocities: forwarding, and a PID around the position."""

import pytest

from station.controllers.velocity_controllers import (
    JointGroupVelocityController,
    JointPositionController,
    JointVelocityController,
)


def test_an_ideal_joint_reaches_a_position_set_point(robot, send):
    controller = robot.start(JointPositionController, joint="elbow", pid={"p": 10.0})
    send(controller, [1.2])
    for _ in range(2000):
        robot.step(controller)
        robot.position[1] += robot.velocities_commanded[1] * 0.001
    # First order with time constant 0.1 s: 20 of them have passed.
    assert robot.position[1] == pytest.approx(1.2, abs=1e-8)


def test_the_position_controller_claims_its_joint_for_velocity_commands(robot):
    controller = robot.load(JointPositionController, joint="elbow", pid={"p": 1.0})
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::VelocityJointInterface"
    assert controller.set_points.elements[0].unit == "rad"
    assert controller.tunables.schema["elbow/p"].unit == "1/s"


@pytest.mark.parametrize(
    ("controller_class", "names"),
    [
        (JointVelocityController, {"joint": "elbow"}),
        (JointGroupVelocityController, {"joints": ["elbow", "wheel"]}),
    ],
)
def test_a_forwarding_controller_claims_its_joints_for_velocity_commands(
    robot, controller_class, names
):
    controller = robot.load(controller_class, **names)
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::VelocityJointInterface"
    assert claimed.resources[0] == "elbow"
    assert controller.set_points.elements[0].unit == "rad/s"
