"""velocity_controllers/JointPositionController."""

import pytest

from station.controllers.velocity_controllers import JointPositionController


def test_an_ideal_joint_reaches_the_set_point(robot, send):
    controller = robot.start(JointPositionController, joint="elbow", pid={"p": 10.0})
    send(controller, [1.2])
    for _ in range(2000):
        robot.step(controller)
        robot.position[1] += robot.velocities_commanded[1] * 0.001
    # First order with time constant 0.1 s: 20 of them have passed.
    assert robot.position[1] == pytest.approx(1.2, abs=1e-8)


def test_it_claims_its_joint_for_velocities(robot):
    controller = robot.load(JointPositionController, joint="elbow", pid={"p": 1.0})
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::VelocityJointInterface"
    assert controller.set_points.elements[0].unit == "rad"
    assert controller.gain_schema()["elbow/p"].unit == "1/s"
