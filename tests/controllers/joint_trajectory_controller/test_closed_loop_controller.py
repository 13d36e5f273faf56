"""Trajectories by efforts and velocities: PID and feed-forward."""

import pytest

from station.controllers.joint_trajectory_controller import (
    effort_controllers,
    velocity_controllers,
)
from station.core.errors import InvalidGainError, ParameterError
from station.core.ports.goal import GoalStatus

JOINTS = ["slide", "elbow"]
GAINS = {"slide": {"p": 400.0, "d": 40.0}, "elbow": {"p": 400.0, "d": 40.0}}


def _start(robot, module=effort_controllers, **values):
    defaults = {"joints": JOINTS, "gains": GAINS}
    return robot.start(module.JointTrajectoryController, **(defaults | values))


def _goal(controller, *points):
    keys = ("time_from_start", "positions", "velocities", "accelerations")
    return controller.goals.submit({
        "trajectory": {
            "joint_names": JOINTS,
            "points": [dict(zip(keys, point, strict=False)) for point in points],
        }
    })


@pytest.mark.parametrize("module", [effort_controllers, velocity_controllers])
def test_starting_commands_nothing(robot, module):
    robot.position[:] = [0.2, 1.0, 0.0]
    controller = _start(robot, module)
    robot.step(controller)
    assert robot.efforts_commanded == robot.velocities_commanded == [0.0] * 3


def test_efforts_answer_errors_of_position_and_velocity(robot):
    controller = _start(robot)
    robot.step(controller)
    robot.position[1] = -0.1
    robot.velocity[1] = 0.5
    robot.step(controller)
    assert robot.efforts_commanded[1] == pytest.approx(400 * 0.1 - 40 * 0.5)


def test_a_share_of_the_desired_velocity_is_fed_forward(robot):
    controller = _start(
        robot,
        velocity_controllers,
        gains={"slide": {"p": 0.0}, "elbow": {"p": 0.0}},
        velocity_ff={"elbow": 0.8},
    )
    robot.step(controller)
    _goal(controller, (1.0, [0.2, 1.0]))
    robot.step(controller, count=10)
    assert robot.velocities_commanded[:2] == pytest.approx([0.0, 0.8])


def test_unit_masses_follow_a_smooth_trajectory(robot):
    controller = _start(robot, constraints={"goal_time": 0.5, "slide": {"goal": 0.01}})
    robot.step(controller)
    rest = [0.0, 0.0]
    goal = _goal(
        controller, (0.8, [0.2, 1.0], [0.1, 0.2], rest), (1.6, [0.3, 0.5], rest, rest)
    )
    worst = 0.0
    for _ in range(2200):
        robot.run_with_effort(controller, 1)
        worst = max(worst, *(abs(error) for error in controller.sample.error))
    assert goal.status is GoalStatus.SUCCEEDED
    # Without feed-forward the error is acceleration / p: about 10 / 400.
    assert worst < 0.03


def test_gains_are_required(robot):
    with pytest.raises(ParameterError, match="'arm/elbow/pid/p' is missing"):
        _start(robot, gains={"slide": {"p": 1.0}})


def test_gains_change_by_name_beside_the_speed(robot):
    controller = _start(robot)
    changed = controller.gains() | {"elbow/p": 7.0, "speed_scaling": 0.5}
    assert set(changed) == set(controller.gain_schema())
    controller.check_gains(changed)
    controller.apply_gains(changed)
    assert controller.gains() == changed
    with pytest.raises(InvalidGainError, match="elbow/i_clamp_min"):
        controller.check_gains(
            changed | {"elbow/i_clamp_min": 1.0, "elbow/i_clamp_max": 0.0}
        )
