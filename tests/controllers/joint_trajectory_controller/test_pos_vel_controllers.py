"""pos_vel_controllers/JointTrajectoryController: commands of 2 values a joint."""

import pytest

from station.controllers.joint_trajectory_controller.pos_vel_controllers import (
    JointTrajectoryController,
)
from station.core.hardware.interfaces import (
    JointStateInterface,
    PosVelJointHandle,
    PosVelJointInterface,
)


@pytest.fixture
def commands(robot):
    """Let the robot take 2 values per joint; return where they arrive."""
    commands = [[0.0] * 3 for _ in range(2)]
    interface = PosVelJointInterface()
    states = robot.get(JointStateInterface)
    for index, state in enumerate(states.handles()):
        interface.register_handle(PosVelJointHandle(state, *commands, index))
    robot.register_interface(interface)
    return commands


def test_starting_commands_rest(robot, commands):
    robot.position[:] = [0.1, 0.2, 0.3]
    controller = robot.start(JointTrajectoryController, joints=["slide", "elbow"])
    robot.step(controller)
    assert commands == [[0.1, 0.2, 0.0], *[[0.0] * 3 for _ in commands[1:]]]
    assert controller.claims[0].resources == ("elbow", "slide")


def test_it_commands_the_desired_states(robot, commands):
    controller = robot.start(JointTrajectoryController, joints=["elbow"])
    robot.step(controller)
    rest = {"velocities": [0.0], "accelerations": [0.0]}
    point = {"positions": [1.0], "time_from_start": 1.0, **rest}
    controller.goals.submit({
        "trajectory": {"joint_names": ["elbow"], "points": [point]}
    })
    robot.step(controller, count=250)
    desired = controller.trajectory_state.desired
    assert desired.position[0] > 0.0
    values = [desired.position[0], desired.velocity[0], desired.acceleration[0]]
    assert [column[1] for column in commands] == values[:2]
    assert controller.sample.output == desired.position
