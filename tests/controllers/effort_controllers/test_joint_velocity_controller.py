"""effort_controllers/JointVelocityController."""

import pytest

from station.controllers.effort_controllers import JointVelocityController
from station.core.errors import ParameterError


def test_a_unit_mass_reaches_the_velocity(robot, send):
    controller = robot.start(JointVelocityController, joint="elbow", pid={"p": 50.0})
    send(controller, [1.5])
    robot.run_with_effort(controller, count=1000)
    # First order with time constant 0.02 s: 50 of them have passed.
    assert robot.velocity[1] == pytest.approx(1.5, abs=1e-9)


def test_set_points_are_velocities_within_the_limits(robot):
    controller = robot.load(JointVelocityController, joint="elbow", pid={"p": 5.0})
    (element,) = controller.set_points.elements
    assert (element.unit, element.minimum, element.maximum) == ("rad/s", -2.0, 2.0)


def test_gains_are_required(robot):
    with pytest.raises(ParameterError, match="'arm/elbow/pid/p' is missing"):
        robot.load(JointVelocityController, joint="elbow")
