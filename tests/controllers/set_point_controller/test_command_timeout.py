"""Silence of whoever commands: off, hold or stop, on the wall clock."""

import pytest

from station.controllers import CONTROLLERS
from station.controllers.position_controllers import JointGroupPositionController
from station.controllers.velocity_controllers import JointGroupVelocityController
from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.errors import CommandTimeoutError, ParameterError
from station.core.parameters import Parameters, ParameterTree
from station.core.ports.set_point import (
    TimeoutAction,
    read_command_timeout,
)


def _start(robot, controller_class=JointGroupVelocityController, **values):
    controller = robot.start(controller_class, joints=["wheel"], **values)
    controller.set_points.clock = ManualClock()
    return controller, controller.set_points.clock


def test_without_the_parameter_a_set_point_is_valid_for_ever(robot, send):
    controller, clock = _start(robot)
    send(controller, [1.0])
    clock.advance(1e6)
    robot.step(controller)
    assert robot.velocities_commanded[2] == 1.0


def test_after_a_timeout_the_robot_rests_until_the_next_set_point(robot, send):
    controller, clock = _start(robot, command_timeout=0.2)
    send(controller, [1.0])
    robot.step(controller)
    clock.advance(0.19)
    robot.step(controller)
    assert robot.velocities_commanded[2] == 1.0
    clock.advance(0.02)
    robot.step(controller)
    assert robot.velocities_commanded[2] == 0.0
    assert controller.set_points.last == [0.0]
    send(controller, [0.5])
    robot.step(controller)
    assert robot.velocities_commanded[2] == 0.5


def test_a_position_controller_holds_the_position_of_the_moment(robot, send):
    controller, clock = _start(robot, JointGroupPositionController, command_timeout=0.2)
    send(controller, [2.0])
    robot.step(controller)
    robot.position[2] = 0.7
    clock.advance(0.3)
    robot.step(controller)
    robot.position[2] = 0.8
    robot.step(controller)
    assert robot.positions_commanded[2] == 0.7


def test_a_set_point_that_aged_while_the_loop_stood_still_is_never_used(robot, send):
    controller, clock = _start(robot, command_timeout=0.2)
    send(controller, [1.0])
    clock.advance(10.0)
    robot.step(controller)
    assert robot.velocities_commanded[2] == 0.0


def test_stop_fails_with_the_reason(robot, send):
    controller, clock = _start(
        robot, command_timeout=0.2, command_timeout_action="stop"
    )
    send(controller, [1.0])
    robot.step(controller)
    clock.advance(0.3)
    with pytest.raises(CommandTimeoutError, match="No set-point for wheel"):
        robot.step(controller)


def test_stop_waits_for_the_first_set_point(robot):
    controller, clock = _start(
        robot, command_timeout=0.2, command_timeout_action="stop"
    )
    clock.advance(10.0)
    robot.step(controller, count=3)
    assert controller.is_running()


def test_off_ignores_the_timeout(robot, send):
    controller, clock = _start(robot, command_timeout=0.2, command_timeout_action="off")
    send(controller, [1.0])
    clock.advance(10.0)
    robot.step(controller)
    assert robot.velocities_commanded[2] == 1.0


def test_a_set_point_can_bring_its_own_time_limit(robot):
    controller, clock = _start(robot)
    controller.set_points.post([1.0], timeout=0.05)
    robot.step(controller)
    assert robot.velocities_commanded[2] == 1.0
    clock.advance(0.06)
    robot.step(controller)
    assert robot.velocities_commanded[2] == 0.0


def test_starting_forgets_a_running_time_limit(robot):
    controller, clock = _start(robot, command_timeout_action="stop")
    controller.set_points.post([1.0], timeout=0.05)
    robot.step(controller)
    controller.stop_request(robot.time)
    clock.advance(1.0)
    controller.start_request(robot.time)
    robot.step(controller)
    assert controller.is_running()


def test_the_manager_lends_its_clock(robot):
    clock = ManualClock()
    robot.tree.set(
        "arm",
        {
            "type": "velocity_controllers/JointGroupVelocityController",
            "joints": ["wheel"],
        },
    )
    loaders = [TableLoader(CONTROLLERS)]
    manager = ControllerManager(robot, Parameters(robot.tree), loaders, clock)
    manager.load_controller("arm")
    assert manager.get_controller("arm").set_points.clock is clock


@pytest.mark.parametrize(
    "values", [{"command_timeout": -1.0}, {"command_timeout_action": "explode"}]
)
def test_impossible_parameters_are_refused(values):
    with pytest.raises(ParameterError, match="arm/command_timeout"):
        read_command_timeout(Parameters(ParameterTree({"arm": values}), "arm"))


def test_the_default_is_to_hold_and_no_timeout():
    assert read_command_timeout(Parameters()) == (0.0, TimeoutAction.HOLD)
