"""A PID around the velocity, the case without any angles."""

import pytest

from station.controllers.effort_controllers import JointVelocityController


def _start(robot):
    return robot.start(JointVelocityController, joint="elbow", pid={"p": 5.0})


def test_it_starts_at_rest(robot):
    controller = _start(robot)
    robot.step(controller)
    assert robot.efforts_commanded == [0.0, 0.0, 0.0]


def test_the_error_is_the_missing_velocity(robot, send):
    controller = _start(robot)
    robot.velocity[1] = 0.4
    send(controller, [1.0])
    robot.step(controller)
    assert robot.efforts_commanded[1] == pytest.approx(3.0)
    assert controller.sample.desired == [1.0]
    assert controller.sample.actual == [0.4]
    assert controller.sample.error == pytest.approx([0.6])
    assert controller.sample.output == pytest.approx([3.0])


def test_gains_change_by_name(robot, send):
    controller = _start(robot)
    changed = controller.gains() | {"elbow/p": 7.0}
    controller.check_gains(changed)
    controller.apply_gains(changed)
    send(controller, [1.0])
    robot.step(controller)
    assert robot.efforts_commanded[1] == pytest.approx(7.0)
    assert controller.gain_schema()["elbow/p"].unit == "Nm s/rad"
